// Fronts: one number per triangle that travels over the model. Mirror of `effects::hooks::Front`, where each is explained.
//@ use common/hash

const FRONT_SWEEP = 1u;
const FRONT_RADIAL = 2u;
const FRONT_RANDOM = 3u;

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

// How far the front has passed a triangle: 0 untouched, 1 behind it.
fn front_reached(front: Front, center: vec3f, center_screen: vec2f, triangle: u32) -> f32 {
    var place = 0.0;
    switch front.pattern {
        case FRONT_SWEEP: {
            let reach = max(abs(front.along.x) + abs(front.along.y), 1e-3);
            place = 0.5 + dot(center_screen - 0.5, front.along) / reach;
        }
        case FRONT_RADIAL: {
            return clamp((front.radius_m - length(center - front.center)) / front.width_m + 0.5, 0.0, 1.0);
        }
        case FRONT_RANDOM: {
            place = hash_unit(triangle ^ (front.seed * 0x9e3779b9u));
        }
        default: { return 1.0; }
    }
    return clamp((front.progress * (1.0 + front.width) - place) / front.width, 0.0, 1.0);
}
