// Shading, x-ray: the average of all layers. A pixel whose sums have overflowed shows a check of magenta and black.
//@ use lib/frame
//@ use lib/color
//@ use lib/picture
//@ use lib/xray_sums
//@ use effects/xray
//@ use glue/effects
//@ use variants/framebuffer_read

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    let first = SUM_WORDS * (pixel.y * frame.size.x + pixel.x);
    var words: vec4u;
    for (var i = 0u; i < SUM_WORDS; i += 1u) { words[i] = framebuffer_load_behind(first + i); }
    let behind = vec4f(color_decode(background.rgb), background.a);
    let mark = vec4f(vec3f(1.0, 0.0, 1.0) * f32(((pixel.x ^ pixel.y) >> 1u) & 1u), 1.0);
    let seen = xray_over(xray_sums_color(words), behind, xray_sums_weight(words), effects.xray);
    return select(seen, mark, xray_sums_is_full(words));
}
