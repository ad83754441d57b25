// Zoom blur: everything rushes towards a point of the picture.

struct ZoomBlur {
    /// The point, 0 to 1 from the left.
    @range(0.0, 1.0, 0.5) x: f32,
    /// The same from the top.
    @range(0.0, 1.0, 0.45) y: f32,
    /// How far.
    @range(0.0, 0.5, 0.15) amount: f32,
}

fn zoom_blur(at: ImageAt, p: ZoomBlur) -> vec4f {
    let middle = image_middle(at);
    let away = vec2f(p.x, p.y) * vec2f(at.size) - middle;
    var sum = vec4f(0.0);
    for (var i = 0; i < 12; i++) {
        let place = middle + away * (p.amount * f32(i) / 11.0);
        sum += image_color_at(place.x, place.y);
    }
    return sum / 12.0;
}
