// Visibility sum: every layer adds its weighted colour, in linear light and as integers, and its weight. Sums commute, so
// no order shows. Only a sum of weights beyond what fits can have overflowed: such pixels are counted.
//@ use common/shade
//@ use common/counters
//@ use slot/sums
//@ use glue/surface

// Bits per channel in the sums.
override SUM_BITS: u32 = 12u;

fn visibility_write(pixel: u32, key: u32, id: u32) {
    if key < xray_threshold(sums_front(pixel), IS_PERSPECTIVE, effects.xray) { return; }
    let surface = glue_surface(shade_surface(id, vec2u(pixel % frame.size.x, pixel / frame.size.x)));
    let weight = xray_weight(surface, effects.xray);
    let whole = (1u << SUM_BITS) - 1u;
    let color = vec3u(round(clamp(surface.color.rgb, vec3f(0.0), vec3f(1.0)) * f32(whole))) * weight;
    sums_add(pixel, 0u, color.r);
    sums_add(pixel, 1u, color.g);
    sums_add(pixel, 2u, color.b);
    let before = sums_add(pixel, 3u, weight);
    let capacity = 0xffffffffu / whole;
    if before <= capacity && before + weight > capacity { atomicAdd(&counters.full_pixels, 1u); }
}
