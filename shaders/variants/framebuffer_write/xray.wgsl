// Framebuffer, x-ray: every layer adds its weighted color, in linear light and as integers, and its weight. Sums commute, so
// the order of layers does not matter. Pixels whose sums may have overflowed are counted.
//@ use lib/frame
//@ use lib/geometry
//@ use lib/shade
//@ use lib/xray_sums
//@ use effects/xray
//@ use glue/effects
//@ use glue/surface
//@ use variants/xray_buffer

// All layers count, so none waits until the nearest is known: the same pass finds it.
override FINDS_NEAREST: bool = false;

fn framebuffer_begin(id: u32) -> bool {
    shade_begin(id);
    return true;
}

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    if FINDS_NEAREST {
        xray_buffer_nearest(pixel, key, id);
    } else if key < xray_threshold(xray_buffer_front(pixel), IS_PERSPECTIVE, effects.xray) {
        return;
    }
    let surface = glue_surface(shade_surface(vec2u(pixel % frame.size.x, pixel / frame.size.x)), shaded.draw);
    let weight = xray_weight(surface, effects.xray);
    let layer = xray_sums_layer(clamp(surface.color.rgb, vec3f(0.0), vec3f(1.0)), weight);
    let before = xray_buffer_add(pixel, layer);
    if xray_sums_overflow(before, weight) { atomicAdd(&counters.full_pixels, 1u); }
}
