// Vignette: the picture darkens towards its corners, as through a lens.
//@ use lib/image
//@ use lib/image_pass

struct Vignette {
    color: vec4f,
    amount: f32,
    reach: f32,
    roundness: f32,
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
