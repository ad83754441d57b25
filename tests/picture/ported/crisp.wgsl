// Crisp: sharpens where there is room for it, so that nothing becomes brighter or darker than its surroundings.

struct Crisp {
    /// How sharp.
    @range(0.0, 1.0, 0.6) amount: f32,
}

fn crisp(at: ImageAt, p: Crisp) -> vec4f {
    let here = image_color(at.x, at.y);
    let up = image_color(at.x, at.y - 1).rgb;
    let down = image_color(at.x, at.y + 1).rgb;
    let left = image_color(at.x - 1, at.y).rgb;
    let right = image_color(at.x + 1, at.y).rgb;
    let least = min(here.rgb, min(min(up, down), min(left, right)));
    let most = max(here.rgb, max(max(up, down), max(left, right)));
    let room = clamp(min(least, 1.0 - most) / max(most, vec3f(0.001)), vec3f(0.0), vec3f(1.0));
    let weight = -0.2 * p.amount * room;
    let color = (here.rgb + weight * (up + down + left + right)) / (1.0 + 4.0 * weight);
    return vec4f(clamp(color, least, most), here.a);
}
