// Lava: a black crust on something that glows, and flows.
//@ use lib/noise
//@ use lib/surface

struct Lava {
    /// Color of the glow.
    @color(1.0, 0.25, 0.03) hot: vec4f,
    /// Cracks per meter.
    @range(0.3, 8.0, 2.0) scale: f32,
    /// The moment.
    @range(0.0, 10.0, 0.0) time: f32,
}

fn lava(surface: Surface, p: Lava) -> Surface {
    var s = surface;
    let place = p.scale * s.position + vec3f(0.0, -0.2 * p.time, 0.0);
    let crack = 1.0 - abs(noise_simplex(place, 1u) + 0.5 * noise_simplex(2.0 * place, 2u));
    let heat = clamp(crack, 0.0, 1.0);
    let glow = heat * heat * heat * heat * heat * heat;
    s.color = vec4f(vec3f(0.02) + p.hot.rgb * 1.5 * glow, s.color.a);
    s.glow = p.hot.rgb * 1.5 * glow;
    return s;
}
