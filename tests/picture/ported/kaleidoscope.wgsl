// Kaleidoscope: one quarter of the picture, mirrored, and each of those again along its diagonal.

struct Kaleidoscope {
    /// How much larger the part is shown.
    @range(0.5, 4.0, 1.2) scale: f32,
    /// Mirror along the diagonals, too.
    @toggle(1) diagonal: u32,
}

fn kaleidoscope(at: ImageAt, p: Kaleidoscope) -> vec4f {
    let size = vec2f(image_size());
    var away = abs(image_middle(at) - 0.5 * size);
    if p.diagonal != 0u {
        away = vec2f(max(away.x, away.y), min(away.x, away.y));
    }
    let place = 0.5 * size + away / p.scale;
    return image_color_at(place.x, place.y);
}
