// Fog: blends towards a color with distance (Beer–Lambert).
//@ use lib/surface

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
    let fraction = 1.0 - exp(-thickness * max(s.depth_m - p.start_m, 0.0));
    s.glow *= 1.0 - fraction;
    s.color = vec4f(s.color.rgb + (p.color.rgb - s.color.rgb) * fraction, s.color.a);
    return s;
}
