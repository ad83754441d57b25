// Facet: blends every triangle between smooth and flat, in normal and in depth.
//@ use lib/surface
//@ use lib/front

struct Facet {
    /// How flat a triangle becomes: 0 keeps it smooth, 1 is fully flat.
    @range(0, 1, 1) amount: f32,
    /// Center of the radial front, world space.
    @point(0, 0, 0) @soft(-3, 3) @unit(m) @when(pattern, radial) center: vec4f,
    /// How the effect is spread over the triangles.
    @choice(uniform, sweep, radial, random) pattern: u32,
    /// Progress of the front: 0 before the first triangle, 1 past the last.
    @range(0, 1, 0.5) @when(pattern, sweep, random) front: f32,
    /// Softness of the front, as a fraction of its path.
    @range(0.001, 2, 0.25) @hard(0.001, 100) @log @when(pattern, sweep, random) width: f32,
    /// Direction of the sweep in the picture: part to the right.
    @range(-1, 1, 1) @when(pattern, sweep) along_x: f32,
    /// Direction of the sweep in the picture: part downwards.
    @range(-1, 1, 0) @when(pattern, sweep) along_y: f32,
    /// Distance of the front from the center.
    @range(0, 5, 1) @hard(0, 1e6) @unit(m) @when(pattern, radial) radius_m: f32,
    /// Thickness of the front.
    @range(0.01, 5, 0.5) @hard(0.001, 1e6) @unit(m) @log @when(pattern, radial) width_m: f32,
    /// Seed of everything random in the effect.
    @range(0, 999, 1) @hard(0, 4294967295) @when(pattern, random) seed: u32,
}

@smooth
fn facet(surface: Surface, p: Facet) -> Surface {
    var s = surface;
    let t = p.amount * front_reached(facet_front(p), s.center, s.center_screen, s.triangle_id);
    if t <= 0.0 { return s; }
    s.depth_m += (s.flat_depth_m - s.depth_m) * t;
    let blended = s.normal + (s.flat_normal - s.normal) * t;
    if t >= 1.0 || dot(blended, blended) < 1e-12 { s.normal = s.flat_normal; } else { s.normal = normalize(blended); }
    return s;
}

fn facet_front(p: Facet) -> Front {
    return Front(p.center, p.pattern, p.front, p.width, p.along_x, p.along_y, p.radius_m, p.width_m, p.seed);
}
