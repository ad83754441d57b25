// Wash: mixes the surface with one color.
//@ use lib/surface

struct Wash {
    /// Color of the wash.
    @color(0.95, 0.45, 0.15) tint: vec4f,
    /// Strength of the wash.
    @range(0.0, 1.0, 0.5) amount: f32,
}

fn wash(surface: Surface, p: Wash) -> Surface {
    var s = surface;
    s.color = vec4f(mix(s.color.rgb, p.tint.rgb, p.amount), s.color.a);
    return s;
}
