// Shading, average: a pixel shows the average of its layers, divided in integers. One whose sums have overflowed shows a
// check of magenta and black.
//@ use common/frame
//@ use common/color
//@ use slot/owner
//@ use common/surface
//@ use glue/surface

// Bits per channel in the sums.
override SUM_BITS: u32 = 12u;

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    let first = 4u * (pixel.y * frame.size.x + pixel.x);
    let weight = owner_beyond(first + 3u);
    let whole = (1u << SUM_BITS) - 1u;
    let average = vec3f(vec3u(
        xray_average(owner_beyond(first), weight),
        xray_average(owner_beyond(first + 1u), weight),
        xray_average(owner_beyond(first + 2u), weight))) / f32(whole);
    let background = vec4f(color_decode(frame.background.rgb), frame.background.a);
    let is_full = weight > 0xffffffffu / whole;
    let mark = vec4f(vec3f(1.0, 0.0, 1.0) * f32(((pixel.x ^ pixel.y) >> 1u) & 1u), 1.0);
    return select(xray_seen(average, background, weight, effects.xray), mark, is_full);
}
