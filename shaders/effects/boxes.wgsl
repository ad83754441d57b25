// Boxes: fills the whole bounding box of every triangle, as a rasterizer without its inside test would.
//@ use lib/surface

struct Boxes {
    tint: vec4f,
}

fn boxes(surface: Surface, p: Boxes) -> Surface {
    var s = surface;
    // Outside the triangle at least one barycentric is clamped to 0.
    let is_outside = min(min(s.barycentrics.x, s.barycentrics.y), s.barycentrics.z) <= 0.0;
    if is_outside { s.glow *= 1.0 - p.tint.a; }
    if is_outside { s.color = vec4f(mix(s.color.rgb, p.tint.rgb, p.tint.a), s.color.a); }
    return s;
}
