// Type: tints the surface where it faces away from the viewer.
//
// A surface effect says what color a visible sample has. `Surface` has its
// position, normals, depth, barycentric coordinates and more; docs/effects.md
// lists them. Save this file, and the picture changes.
//@ use lib/angle
//@ use lib/surface

struct Type {
    /// Color of the rim.
    @color(0.95, 0.45, 0.15) tint: vec4f,
    /// Strength of the tint.
    @range(0.0, 1.0, 0.8) amount: f32,
    /// How narrow the rim is.
    @range(0.5, 8.0, 2.0) @log falloff: f32,
    /// How often it pulses.
    @range(0.0, 4.0, 0.0) @unit(/s) pulse: f32,
    // The time, which no one sets: what moves with it is drawn again while the
    // clock runs.
    @given(seconds) time_s: f32,
}

fn NAME(surface: Surface, p: Type) -> Surface {
    var s = surface;
    let rim = pow(1.0 - clamp(dot(s.normal, s.view), 0.0, 1.0), p.falloff);
    let beat = 0.5 + 0.5 * cosine_turns(p.pulse * p.time_s);
    let color = mix(s.color.rgb, p.tint.rgb, rim * p.amount * beat);
    s.color = vec4f(color, s.color.a);
    return s;
}
