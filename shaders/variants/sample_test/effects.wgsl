// Sample test, effects: the sample effects of the stack. The glue loads the setup of each from lib/sample_setup.
//@ use lib/triangle
//@ use lib/areas
//@ use lib/sample
//@ use lib/sample_setup
//@ use glue/sample

fn sample_test_effects(t: Triangle, at: vec2u, pixel: u32) -> bool {
    return glue_sample(Sample(at, t.id, areas_at(t, at), vec4u()), t.draw, t.entry);
}
