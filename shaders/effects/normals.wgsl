// Normals: colors the surface by the direction it faces, x red, y green, z blue.
//@ use lib/surface

struct Normals {
    amount: f32,
}

fn normals(surface: Surface, p: Normals) -> Surface {
    var s = surface;
    let shade = s.normal * 0.5 + 0.5;
    s.glow *= 1.0 - p.amount;
    s.color = vec4f(s.color.rgb + (shade - s.color.rgb) * p.amount, s.color.a);
    return s;
}
