// Shading, average: a pixel shows the average of its layers, divided in integers. One whose sums have overflowed shows a
// check of magenta and black.
//@ use common/frame
//@ use common/color
//@ use slot/average
//@ use common/surface
//@ use glue/surface

fn shading_color(id: u32, pixel: vec2u) -> vec4f {
    let average = average_of(pixel.y * frame.size.x + pixel.x);
    let background = vec4f(color_decode(frame.background.rgb), frame.background.a);
    let mark = vec4f(vec3f(1.0, 0.0, 1.0) * f32(((pixel.x ^ pixel.y) >> 1u) & 1u), 1.0);
    return select(xray_seen(average.color, background, average.weight, effects.xray), mark, average.is_full);
}
