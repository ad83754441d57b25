// Finish steps: what the resolve pass does to a pixel's gamma-encoded color before it is stored: first the dots, then the
// image effects of the stack.
//@ steps fn finish_step(encoded: vec4f, pixel: vec2u) -> vec4f

//@ step dots
// The strongest dot of a pixel over its surface, or over the background alone.
//@ use lib/frame
//@ use lib/picture
//@ use lib/dots

fn finish_step_dots(encoded: vec4f, pixel: vec2u) -> vec4f {
    let strength = f32(color[color_end() + pixel.y * frame.size.x + pixel.x]) / 256.0;
    let beneath = select(background, encoded, dot_frame.model != 0u);
    return mix(beneath, vec4f(dot_frame.ink.rgb, 1.0), strength * dot_frame.ink.a);
}

//@ step effects
// The image effects of the stack, one after the other.
//@ use lib/image
//@ use glue/image

fn finish_step_effects(encoded: vec4f, pixel: vec2u) -> vec4f {
    return glue_image(Pixel(clamp(encoded, vec4f(0.0), vec4f(1.0)), pixel.x, pixel.y)).color;
}
