// Smooth edges: pixels are mixed along edges of brightness, so that stairs become slopes.
//@ use lib/color

struct SmoothEdges {
    /// Contrast below which nothing changes.
    @range(0.01, 0.5, 0.1) threshold: f32,
    /// How much is mixed.
    @range(0.0, 1.0, 0.75) strength: f32,
}

fn light(x: i32, y: i32) -> f32 {
    return sqrt(max(color_luminance(image_color(x, y).rgb), 0.0));
}

fn smooth_edges(at: ImageAt, p: SmoothEdges) -> vec4f {
    let here = image_color(at.x, at.y);
    let middle = light(at.x, at.y);
    let sides = vec4f(light(at.x, at.y - 1), light(at.x, at.y + 1), light(at.x - 1, at.y), light(at.x + 1, at.y));
    let most = max(middle, max(max(sides.x, sides.y), max(sides.z, sides.w)));
    let least = min(middle, min(min(sides.x, sides.y), min(sides.z, sides.w)));
    let amount = p.strength * clamp((most - least - p.threshold) / p.threshold, 0.0, 1.0);
    let is_level = abs(sides.x + sides.y - 2.0 * middle) >= abs(sides.z + sides.w - 2.0 * middle);
    let step = select(vec2i(1, 0), vec2i(0, 1), is_level);
    let mean = 0.25 * (image_color(at.x - step.x, at.y - step.y) + image_color(at.x + step.x, at.y + step.y)) + 0.5 * here;
    return mix(here, mean, amount);
}
