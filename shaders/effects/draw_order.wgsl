// Draw order: stops the picture after a number of samples.
//@ use lib/surface

struct DrawOrder {
    /// Color of what is drawn first; alpha is its weight against the surface's color.
    @color(0.05, 0.1, 0.5, 0) first: vec4f,
    /// Color of what is drawn last; alpha is its weight against the surface's color.
    @color(1, 0.35, 0.05, 0) last: vec4f,
    /// In which order samples are counted.
    @choice(submission, scheduler) mode: u32,
    /// How the limit is given.
    @choice(fraction, count) unit: u32,
    /// Samples to draw.
    @range(0, 200000, 20000) @hard(0, 4294967295) @when(unit, count) limit: u32,
    /// Fraction of all samples to draw.
    @range(0, 1, 0.5) @when(unit, fraction) fraction: f32,
}

@smooth
fn draw_order(surface: Surface, p: DrawOrder) -> Surface {
    var s = surface;
    let heat = mix(p.first, p.last, s.rank);
    s.glow *= 1.0 - heat.a;
    s.color = vec4f(mix(s.color.rgb, heat.rgb, heat.a), s.color.a);
    return s;
}
