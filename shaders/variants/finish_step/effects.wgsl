// Finish step, effects: the image effects of the stack, one after the other.
//@ use lib/image
//@ use glue/image

fn finish_step_effects(encoded: vec4f, pixel: vec2u) -> vec4f {
    return glue_image(Pixel(clamp(encoded, vec4f(0.0), vec4f(1.0)), pixel.x, pixel.y)).color;
}
