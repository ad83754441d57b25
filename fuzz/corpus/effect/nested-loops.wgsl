//@ use lib/surface

struct Ink {
    /// Strength.
    @range(0.0, 1.0, 0.5) amount: f32,
}

fn helper(x: f32) -> f32 {
    return 2.0 * x;
}

fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    for (var i = 0u; i < 999u; i++) { for (var j = 0u; j < 999u; j++) { s.color *= 0.9; } }
    return s;
}
