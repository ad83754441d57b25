// Visibility sum: every layer adds its weighted colour, in linear light and as integers, and its weight. Sums commute, so
// no order shows. Only a sum of weights beyond what fits can have overflowed: such pixels are counted.
//@ use common/shade
//@ use common/counters
//@ use slot/sums
//@ use slot/totals
//@ use glue/surface

fn visibility_begin(id: u32) {
    shade_begin(id);
}

fn visibility_write(pixel: u32, key: u32, id: u32) {
    if key < xray_threshold(sums_front(pixel), IS_PERSPECTIVE, effects.xray) { return; }
    let surface = glue_surface(shade_surface(vec2u(pixel % frame.size.x, pixel / frame.size.x)));
    let weight = xray_weight(surface, effects.xray);
    if totals_add(pixel, clamp(surface.color.rgb, vec3f(0.0), vec3f(1.0)), weight) { atomicAdd(&counters.full_pixels, 1u); }
}
