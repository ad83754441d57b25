// Afterglow: what is bright glows on for a while and drifts upwards, as sparks that leave the picture a frame late.
//
// The first pass is kept: it reads what it wrote in the frame before, moved and dimmed, and keeps the brighter of that and the picture.

struct Afterglow {
    /// Color that the glow fades to.
    @color(0.12, 0.4, 1.0) tint: vec4f,
    /// Strength of the glow.
    @range(0.0, 2.0, 1.0) strength: f32,
    /// Fraction of the glow that is left a frame later.
    @range(0.0, 0.95, 0.86) lasting: f32,
    /// How far the glow rises from one frame to the next.
    @range(0.0, 12.0, 3.0) @hard(0.0, 64.0) @unit(px) rise_px: f32,
}

@kept(14, 0.04)
@pass(half)
fn glow(at: ImageAt, p: Afterglow) -> vec4f {
    let middle = image_middle(at);
    let now = image_color_at(middle.x, middle.y).rgb;
    // Places of this pass are pixels of half the size; four reads between pixels blur a little in every frame.
    let from_place = 0.5 * middle + vec2f(0.0, 0.5 * p.rise_px);
    let left = image_kept_at(from_place.x - 0.5, from_place.y) + image_kept_at(from_place.x + 0.5, from_place.y);
    let faded = 0.5 * p.lasting * left.rgb * mix(vec3f(1.0), p.tint.rgb, 0.25);
    return vec4f(max(now * now, faded), 1.0);
}

fn lay_over(at: ImageAt, p: Afterglow) -> vec4f {
    let color = image_color(at.x, at.y);
    let middle = 0.5 * image_middle(at);
    let light = min(p.strength * image_last_at(middle.x, middle.y).rgb, vec3f(1.0));
    return vec4f(color.rgb + light * (1.0 - color.rgb), color.a);
}
