// Draw order: stops the picture after a number of samples, so that one sees the order in which it is drawn.
//@ use lib/surface

struct DrawOrder {
    first: vec4f,
    last: vec4f,
    mode: u32,
    unit: u32,
    limit: u32,
    fraction: f32,
}

fn draw_order(surface: Surface, p: DrawOrder) -> Surface {
    var s = surface;
    let heat = mix(p.first, p.last, s.rank);
    s.glow *= 1.0 - heat.a;
    s.color = vec4f(mix(s.color.rgb, heat.rgb, heat.a), s.color.a);
    return s;
}
