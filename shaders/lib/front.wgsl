// A front that travels over the model and gives every triangle one number. Mirrors `effects::hooks::Front`, which explains
// each member. For an effect with the parameters of a front, the glue makes `<effect>_front(p)`.
//@ use lib/hash

struct Front {
    pattern: u32,
    progress: f32,
    width: f32,
    along: vec2f,
    center: vec3f,
    radius_m: f32,
    width_m: f32,
    seed: u32,
}

const FRONT_SWEEP = 1u;
const FRONT_RADIAL = 2u;
const FRONT_RANDOM = 3u;

// How far the front has passed a triangle: 0 not reached, 1 entirely behind the front.
fn front_reached(front: Front, center: vec3f, center_screen: vec2f, triangle: u32) -> f32 {
    var position = 0.0;
    switch front.pattern {
        case FRONT_SWEEP: {
            let length_of_sweep = max(abs(front.along.x) + abs(front.along.y), 1e-3);
            position = 0.5 + dot(center_screen - 0.5, front.along) / length_of_sweep;
        }
        case FRONT_RADIAL: {
            return clamp((front.radius_m - length(center - front.center)) / front.width_m + 0.5, 0.0, 1.0);
        }
        case FRONT_RANDOM: {
            position = hash_unit(triangle ^ (front.seed * 0x9e3779b9u));
        }
        default: { return 1.0; }
    }
    return clamp((front.progress * (1.0 + front.width) - position) / front.width, 0.0, 1.0);
}
