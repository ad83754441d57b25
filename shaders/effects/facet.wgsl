// Facet: blends every triangle between smooth and flat, in normal and in depth.
//@ use common/surface
//@ use common/hash

struct Facet {
    center: vec4f,
    amount: f32,
    pattern: u32,
    front: f32,
    width: f32,
    along_x: f32,
    along_y: f32,
    radius_m: f32,
    width_m: f32,
    seed: u32,
}

fn facet(surface: Surface, p: Facet) -> Surface {
    var s = surface;
    let t = p.amount * facet_reached(s, p);
    if t <= 0.0 { return s; }
    s.depth_m += (s.flat_depth_m - s.depth_m) * t;
    let blended = s.normal + (s.flat_normal - s.normal) * t;
    if t >= 1.0 || dot(blended, blended) < 1e-12 { s.normal = s.flat_normal; } else { s.normal = normalize(blended); }
    return s;
}

// How far the front has passed the triangle: 0 untouched, 1 behind it.
fn facet_reached(s: Surface, p: Facet) -> f32 {
    var place = 0.0;
    switch p.pattern {
        case FACET_PATTERN_SWEEP: {
            let reach = max(abs(p.along_x) + abs(p.along_y), 1e-3);
            place = 0.5 + dot(s.center_screen - 0.5, vec2f(p.along_x, p.along_y)) / reach;
        }
        case FACET_PATTERN_RADIAL: {
            return clamp((p.radius_m - length(s.center - p.center.xyz)) / p.width_m + 0.5, 0.0, 1.0);
        }
        case FACET_PATTERN_RANDOM: {
            place = hash_unit(s.owner ^ (p.seed * 0x9e3779b9u));
        }
        default: { return 1.0; }
    }
    return clamp((p.front * (1.0 + p.width) - place) / p.width, 0.0, 1.0);
}
