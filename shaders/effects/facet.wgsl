// Facet: blends every triangle between smooth and flat, in normal and in depth.
//@ use lib/surface
//@ use lib/front

struct Facet {
    spread: Front,
    amount: f32,
}

fn facet(surface: Surface, p: Facet) -> Surface {
    var s = surface;
    let t = p.amount * front_reached(p.spread, s.center, s.center_screen, s.triangle_id);
    if t <= 0.0 { return s; }
    s.depth_m += (s.flat_depth_m - s.depth_m) * t;
    let blended = s.normal + (s.flat_normal - s.normal) * t;
    if t >= 1.0 || dot(blended, blended) < 1e-12 { s.normal = s.flat_normal; } else { s.normal = normalize(blended); }
    return s;
}
