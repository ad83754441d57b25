// Type: darkens the corners of the picture.
//
// A pixel effect finishes the picture, background included. `q.color` is
// gamma-encoded; `image_at(x, y)` gives triangle id, depth bits and draw of any
// pixel. docs/effects.md has more.
//@ use lib/image

struct Type {
    /// Strength at the corners.
    @range(0.0, 1.0, 0.6) amount: f32,
    /// How far the light reaches: 1 to the edges of the picture.
    @range(0.2, 3.0, 1.0) @log reach: f32,
}

fn NAME(pixel: Pixel, p: Type) -> Pixel {
    var q = pixel;
    let center = 0.5 * vec2f(image_size());
    let away = (vec2f(f32(q.x), f32(q.y)) + 0.5 - center) / (center * p.reach);
    let dark = p.amount * clamp(0.5 * dot(away, away), 0.0, 1.0);
    q.color = vec4f(q.color.rgb * (1.0 - dark), q.color.a);
    return q;
}
