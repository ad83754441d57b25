// Aberration: colors part towards the edges, as through a simple lens.
//@ use lib/image
//@ use lib/image_pass

struct Aberration {
    /// How far red and blue light part in the corners, each way.
    @range(0, 32, 7) @hard(0, 128) @unit(px) shift_px: f32,
    /// 0: evenly from the middle on, 1: mostly at the edges.
    @range(0, 1, 0.6) edges: f32,
}

const ABERRATION_TAPS = 4; // reads to either side of the middle

fn aberration(at: ImageAt, p: Aberration) -> vec4f {
    let size = vec2f(image_size());
    let middle = image_middle(at);
    // 1 long in the corners.
    let away = (middle - 0.5 * size) / (0.5 * length(size));
    let shift = away * (p.shift_px * mix(1.0, length(away), p.edges));
    var sum = vec3f(0.0);
    var weights = vec3f(0.0);
    for (var i = -ABERRATION_TAPS; i <= ABERRATION_TAPS; i += 1) {
        let t = f32(i) / f32(ABERRATION_TAPS);
        let place = middle + t * shift;
        // Red light comes from farther out, blue light from farther in.
        let weight = max(vec3f(0.0), 1.0 - 2.0 * abs(vec3f(t - 0.5, t, t + 0.5)));
        sum += weight * image_color_at(place.x, place.y).rgb;
        weights += weight;
    }
    return vec4f(sum / weights, image_color(at.x, at.y).a);
}
