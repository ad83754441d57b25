// Samples, hooked: the sample effects of the stack say whether a covered sample is drawn.
//@ use common/decisions
//@ use common/parts
//@ use common/sample
//@ use glue/sample

fn samples_is_drawn(t: Triangle, at: vec2u) -> bool {
    return glue_sample(Sample(at, t.id, parts_of(t, at), vec4u()), t.entry);
}
