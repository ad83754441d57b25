// Scanner: a band of light climbs the model once in a loop of the clock.
//@ use lib/surface

struct Scanner {
    /// Color of the band.
    @color(0.1, 0.9, 1.0) beam: vec4f,
    /// Height at which it begins.
    @range(-3.0, 3.0, -1.2) @unit(m) @height low: f32,
    /// Height at which it ends.
    @range(-3.0, 3.0, 1.2) @unit(m) @height high: f32,
    /// Thickness of the band.
    @range(0.01, 1.0, 0.25) width: f32,
    @given(loop) part: f32,
}

@smooth
fn scanner(surface: Surface, p: Scanner) -> Surface {
    var s = surface;
    let away = (s.position.y - mix(p.low, p.high, p.part)) / p.width;
    let light = p.beam.rgb * exp(-4.0 * away * away);
    s.color += vec4f(light, 0.0);
    s.glow += light;
    return s;
}
