// Framebuffer, x-ray: every layer adds its weighted color, in linear light and as integers, and its weight. Sums commute, so
// the order of layers does not matter. Pixels whose sums may have overflowed are counted, unless the scene has too few triangles for that.
//@ use lib/frame
//@ use lib/geometry
//@ use lib/shade
//@ use lib/xray_sums
//@ use effects/xray
//@ use glue/effects
//@ use glue/surface
//@ use variants/xray_buffer

override SUMS_MAY_OVERFLOW: bool = true;

fn framebuffer_begin(id: u32) -> bool {
    shade_begin(id);
    return true;
}

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    if key < xray_threshold(xray_buffer_front(pixel), IS_PERSPECTIVE, effects.xray) { return; }
    let surface = glue_surface(shade_surface(vec2u(pixel % frame.size.x, pixel / frame.size.x)), shaded.draw);
    let weight = xray_weight(surface, effects.xray);
    let layer = xray_sums_layer(clamp(surface.color.rgb, vec3f(0.0), vec3f(1.0)), weight);
    var before: vec4u;
    for (var i = 0u; i < SUM_WORDS; i += 1u) { before[i] = xray_buffer_add(SUM_WORDS * pixel + i, layer[i]); }
    // Without a use of what an addition returns, it need not be waited for.
    if SUMS_MAY_OVERFLOW && xray_sums_overflow(before, weight) { atomicAdd(&counters.full_pixels, 1u); }
}
