// How an effect is spread over the triangles: a front that gives every triangle one number. Mirrors `effects::hooks::Front`,
// which explains each member.
//@ use lib/hash

struct Front {
    center: vec4f,
    pattern: u32,
    front: f32,
    width: f32,
    along_x: f32,
    along_y: f32,
    radius_m: f32,
    width_m: f32,
    seed: u32,
}

const FRONT_SWEEP = 1u;
const FRONT_RADIAL = 2u;
const FRONT_RANDOM = 3u;

// How far the front has passed a triangle: 0 not reached, 1 entirely behind the front.
fn front_reached(p: Front, center: vec3f, center_screen: vec2f, triangle: u32) -> f32 {
    var position = 0.0;
    switch p.pattern {
        case FRONT_SWEEP: {
            let along = vec2f(p.along_x, p.along_y);
            let length_of_sweep = max(abs(along.x) + abs(along.y), 1e-3);
            position = 0.5 + dot(center_screen - 0.5, along) / length_of_sweep;
        }
        case FRONT_RADIAL: {
            return clamp((p.radius_m - length(center - p.center.xyz)) / p.width_m + 0.5, 0.0, 1.0);
        }
        case FRONT_RANDOM: {
            position = hash_unit(triangle ^ (p.seed * HASH_GOLDEN));
        }
        default: { return 1.0; }
    }
    return clamp((p.front * (1.0 + p.width) - position) / p.width, 0.0, 1.0);
}
