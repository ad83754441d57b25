// Lamps: the picture on a board of round lamps, bright in the middle.
//@ use lib/color

struct Lamps {
    /// Lamps are so far apart.
    @range(3, 32, 6) @unit(px) side_px: i32,
    /// How round they are.
    @range(0.1, 1.0, 0.8) radius: f32,
    /// Light between them.
    @range(0.0, 0.5, 0.05) between: f32,
}

@pass(half)
fn small(at: ImageAt, p: Lamps) -> vec4f {
    let middle = image_middle(at);
    return image_color_at(middle.x, middle.y);
}

fn board(at: ImageAt, p: Lamps) -> vec4f {
    let corner = vec2i(at.x / p.side_px, at.y / p.side_px) * p.side_px;
    let middle = vec2f(corner) + 0.5 * f32(p.side_px);
    let color = image_last_at(0.5 * middle.x, 0.5 * middle.y);
    let away = length(image_middle(at) - middle) / (0.5 * f32(p.side_px));
    let lit = clamp(4.0 * (p.radius - away), 0.0, 1.0);
    return vec4f(color.rgb * max(1.4 * lit * (1.0 - 0.5 * away), p.between), color.a);
}
