// Finish step, dots: the strongest dot of a pixel over its surface, or over the background alone.
//@ use lib/frame
//@ use lib/picture
//@ use lib/dots

fn finish_step_dots(encoded: vec4f, pixel: vec2u) -> vec4f {
    let strength = f32(color[color_end() + pixel.y * frame.size.x + pixel.x]) / 256.0;
    let beneath = select(background, encoded, dot_frame.model != 0u);
    return mix(beneath, vec4f(dot_frame.ink.rgb, 1.0), strength * dot_frame.ink.a);
}
