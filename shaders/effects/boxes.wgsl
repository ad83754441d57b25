// Boxes: fills the whole bounding box of every triangle.
//@ use lib/surface

struct Boxes {
    /// Color of what lies beyond the triangle; alpha is its weight against the surface's color.
    @color(1, 0.2, 0.1, 0) tint: vec4f,
}

@smooth
fn boxes(surface: Surface, p: Boxes) -> Surface {
    var s = surface;
    // Outside the triangle at least one barycentric is clamped to 0.
    let is_outside = min(min(s.barycentrics.x, s.barycentrics.y), s.barycentrics.z) <= 0.0;
    if is_outside { s.glow *= 1.0 - p.tint.a; }
    if is_outside { s.color = vec4f(mix(s.color.rgb, p.tint.rgb, p.tint.a), s.color.a); }
    return s;
}
