// Soft light: a mist of light lies over the picture, as through a silk stocking on the lens.
//
// Four passes: what is bright, at a quarter of the size, spread across and down, and laid over the picture.

struct SoftLight {
    /// Color of the mist.
    @color(1.0, 0.9, 0.78) tint: vec4f,
    /// Strength of the mist.
    @range(0.0, 2.0, 0.9) strength: f32,
    /// How far light spreads.
    @range(4.0, 96.0, 48.0) @hard(4.0, 256.0) @unit(px) radius_px: f32,
    /// How dark the rest becomes.
    @range(0.0, 1.0, 0.3) contrast: f32,
}

@pass(quarter)
fn bright(at: ImageAt, p: SoftLight) -> vec4f {
    let middle = image_middle(at);
    let near = image_color_at(middle.x - 1.0, middle.y - 1.0) + image_color_at(middle.x + 1.0, middle.y - 1.0);
    let far = image_color_at(middle.x - 1.0, middle.y + 1.0) + image_color_at(middle.x + 1.0, middle.y + 1.0);
    let color = 0.25 * (near + far);
    return color * color;
}

@pass(quarter)
fn across(at: ImageAt, p: SoftLight) -> vec4f {
    return mean_along(at, vec2i(1, 0), 0.25 * p.radius_px);
}

@pass(quarter)
fn down(at: ImageAt, p: SoftLight) -> vec4f {
    return mean_along(at, vec2i(0, 1), 0.25 * p.radius_px);
}

fn lay_over(at: ImageAt, p: SoftLight) -> vec4f {
    let color = image_color(at.x, at.y);
    let middle = 0.25 * image_middle(at);
    let mist = p.strength * p.tint.rgb * image_last_at(middle.x, middle.y).rgb;
    let deep = color.rgb * mix(vec3f(1.0), color.rgb, p.contrast);
    return vec4f(deep + mist * (1.0 - deep), color.a);
}

// Weighted mean of what the last pass wrote along a direction.
fn mean_along(at: ImageAt, along: vec2i, radius: f32) -> vec4f {
    let reach = i32(ceil(radius));
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = -reach; i <= reach; i += 1) {
        let t = f32(i) / (radius + 1.0);
        let weight = max(1.0 - t * t, 0.0);
        sum += weight * image_last(at.x + i * along.x, at.y + i * along.y);
        weights += weight;
    }
    return sum / weights;
}
