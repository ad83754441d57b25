// Fog: blends towards a colour with distance (Beer–Lambert).
//@ use common/surface

struct Fog {
    color: vec4f,
    density: f32,
    start_m: f32,
    falloff: f32,
    level_m: f32,
}

fn fog(surface: Surface, p: Fog) -> Surface {
    var s = surface;
    let above = max(s.position.y - p.level_m, 0.0);
    let thickness = p.density * exp(-above * p.falloff);
    let share = 1.0 - exp(-thickness * max(s.depth_m - p.start_m, 0.0));
    s.glow *= 1.0 - share;
    s.color = vec4f(s.color.rgb + (p.color.rgb - s.color.rgb) * share, s.color.a);
    return s;
}
