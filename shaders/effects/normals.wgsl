// Normals: colors the surface by the direction it faces. x is red, y green, z blue.
//@ use lib/surface

struct Normals {
    /// How much of the base color is replaced.
    @range(0, 1, 1) amount: f32,
}

@smooth
fn normals(surface: Surface, p: Normals) -> Surface {
    var s = surface;
    let shade = s.normal * 0.5 + 0.5;
    s.glow *= 1.0 - p.amount;
    s.color = vec4f(s.color.rgb + (shade - s.color.rgb) * p.amount, s.color.a);
    return s;
}
