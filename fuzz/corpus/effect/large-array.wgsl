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
    var a: array<array<f32, 4096>, 4096>; s.color *= a[0][0];
    return s;
}
