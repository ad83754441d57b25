// Ambient: corners and folds darken where little sky reaches them.
//@ use lib/angle
//@ use lib/hash
//@ use lib/image
//@ use lib/image_pass

struct Ambient {
    /// What hidden light is multiplied by, linear; its alpha is the strength.
    @color(0.05, 0.06, 0.1) shade: vec4f,
    /// How far away something still hides the sky; at least a pixel.
    @range(0.01, 10, 0.5) @hard(0.0001, 10000) @unit(m) @log radius_m: f32,
    /// Strength: 1 darkens by the fraction that is hidden.
    @range(0, 4, 2) @hard(0, 16) strength: f32,
    /// The radius in the picture is at most this.
    @range(4, 96, 32) @hard(1, 512) @unit(px) most_px: f32,
    /// How far noise is smoothed, on what is about equally far away.
    @range(0, 8, 3) @hard(0, 16) @unit(px) soft_px: u32,
}

const AMBIENT_TAPS = 20;

// How much is hidden from each pixel, in red, and its reversed depth, in alpha.
fn ambient_find(at: ImageAt, p: Ambient) -> vec4f {
    let here = image_at(at.x, at.y);
    let here_m = image_depth_m(at.x, at.y);
    let depth = bitcast<f32>(here.y);
    if here.x == IMAGE_NO_TRIANGLE { return vec4f(0.0); }
    // On a plane, depths change evenly across the picture.
    let slope = vec2f(ambient_slope(at, depth, vec2i(1, 0)), ambient_slope(at, depth, vec2i(0, 1)));
    let radius_m = ambient_radius_m(here_m, p);
    let reach_px = clamp(p.radius_m / image_pixel_size_m(here_m), 1.0, p.most_px);
    let first = hash_unit(hash(u32(at.x)) + u32(at.y));
    var hidden = 0.0;
    for (var i = 0; i < AMBIENT_TAPS; i += 1) {
        let turns = first + f32(i) * 0.6180339887498949;
        let away = reach_px * (f32(i) + 0.5) / f32(AMBIENT_TAPS);
        let step = vec2i(floor(away * vec2f(cosine_turns(turns), sine_turns(turns)) + 0.5));
        let seen = bitcast<f32>(image_at(at.x + step.x, at.y + step.y).y);
        // How far what is seen there stands out from the plane of this pixel.
        let height = image_meters_apart(seen, (depth - seen) + dot(slope, vec2f(step))) / radius_m;
        hidden += clamp(4.0 * height - 0.1, 0.0, 1.0) * clamp(2.0 - height, 0.0, 1.0);
    }
    return vec4f(hidden / f32(AMBIENT_TAPS), 0.0, 0.0, depth);
}

fn ambient_across(at: ImageAt, p: Ambient) -> vec4f {
    return ambient_mean(at, vec2i(1, 0), p);
}

fn ambient_shade(at: ImageAt, p: Ambient) -> vec4f {
    let color = image_color(at.x, at.y);
    let hidden = clamp(p.strength * p.shade.a * ambient_mean(at, vec2i(0, 1), p).r, 0.0, 1.0);
    return vec4f(color.rgb * mix(vec3f(1.0), p.shade.rgb, hidden), color.a);
}

// No less than a pixel is, whose depth tells nothing smaller.
fn ambient_radius_m(here_m: f32, p: Ambient) -> f32 {
    return max(p.radius_m, image_pixel_size_m(here_m));
}

// The smaller of the changes of depth to both sides.
fn ambient_slope(at: ImageAt, depth: f32, step: vec2i) -> f32 {
    let ahead = bitcast<f32>(image_at(at.x + step.x, at.y + step.y).y) - depth;
    let behind = depth - bitcast<f32>(image_at(at.x - step.x, at.y - step.y).y);
    return select(behind, ahead, abs(ahead) < abs(behind));
}

// Mean along a direction of pixels at about the same depth.
fn ambient_mean(at: ImageAt, along: vec2i, p: Ambient) -> vec4f {
    let here = image_last(at.x, at.y);
    let radius_m = ambient_radius_m(image_meters(here.a), p);
    var sum = 0.0;
    var weights = 0.0;
    let reach = i32(p.soft_px);
    for (var i = -reach; i <= reach; i += 1) {
        let there = image_last(at.x + i * along.x, at.y + i * along.y);
        let apart = image_meters_apart(here.a, there.a - here.a) / radius_m;
        let weight = 1.0 / (1.0 + 16.0 * apart * apart);
        sum += weight * there.r;
        weights += weight;
    }
    return vec4f(sum / weights, 0.0, 0.0, here.a);
}
