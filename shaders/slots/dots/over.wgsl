// Dots, over: the strongest dot of a pixel over its surface, or over the background alone.
//@ use common/picture
//@ use common/dot_frame

fn dots_over(pixel: vec2u, encoded: vec4f) -> vec4f {
    let strength = f32(color[picture_first_dot() + pixel.y * frame.size.x + pixel.x]) / 256.0;
    let beneath = select(frame.background, encoded, dot_frame.model != 0u);
    return mix(beneath, vec4f(dot_frame.ink.rgb, 1.0), strength * dot_frame.ink.a);
}
