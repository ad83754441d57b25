// Vignette: the picture darkens towards its corners. Lenses do the same.
//@ use lib/image
//@ use lib/image_pass

struct Vignette {
    /// What the corners turn to, linear; its alpha is the strength.
    @color(0, 0, 0) color: vec4f,
    /// How far the corners turn to it: 1 entirely.
    @range(0, 1, 0.7) amount: f32,
    /// Where it begins, from the middle of the picture at 0 to its corners at 1.
    @range(0, 0.99, 0.35) reach: f32,
    /// 0: an ellipse in the shape of the picture, 1: a circle.
    @range(0, 1, 0.5) roundness: f32,
}

fn vignette(at: ImageAt, p: Vignette) -> vec4f {
    let size = vec2f(image_size());
    let from_middle = abs(image_middle(at) - 0.5 * size);
    // Distance from the middle: 1 in the corners. A circle in pixels, or an ellipse in the shape of the picture.
    let round = from_middle / (0.5 * length(size));
    let shaped = from_middle / (size * 0.7071067811865476);
    let away = mix(length(shaped), length(round), p.roundness);
    let past = clamp((away - p.reach) / (1.0 - p.reach), 0.0, 1.0);
    let dark = p.amount * p.color.a * past * past * (3.0 - 2.0 * past);
    let color = image_color(at.x, at.y);
    return vec4f(mix(color.rgb, p.color.rgb, dark), color.a);
}
