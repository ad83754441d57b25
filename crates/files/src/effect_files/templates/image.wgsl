// Type: a soft light around what is bright.
//
// An image effect reads the finished picture in linear light: `image_color(x,
// y)`, and `image_last(x, y)` of the pass before it. Its functions are passes,
// one after the other; the last one writes the picture. docs/effects.md has
// more.

struct Type {
    /// Brightness from which a pixel shines.
    @range(0.0, 1.0, 0.6) threshold: f32,
    /// How far the light reaches.
    @range(1.0, 32.0, 8.0) @hard(1.0, 64.0) @unit(px) radius_px: f32,
    /// Strength of the light.
    @range(0.0, 2.0, 1.0) strength: f32,
}

// What shines, at half the size.
@pass(half)
fn NAME_bright(at: ImageAt, p: Type) -> vec4f {
    let middle = image_middle(at);
    let color = image_color_at(middle.x, middle.y);
    let brightest = max(max(color.r, color.g), color.b);
    return color * smoothstep(p.threshold, p.threshold + 0.2, brightest);
}

@pass(half)
fn NAME_across(at: ImageAt, p: Type) -> vec4f {
    return NAME_mean(at, vec2i(1, 0), 0.5 * p.radius_px);
}

@pass(half)
fn NAME_down(at: ImageAt, p: Type) -> vec4f {
    return NAME_mean(at, vec2i(0, 1), 0.5 * p.radius_px);
}

fn NAME(at: ImageAt, p: Type) -> vec4f {
    let color = image_color(at.x, at.y);
    let middle = 0.5 * image_middle(at);
    let light = p.strength * image_last_at(middle.x, middle.y).rgb;
    return vec4f(color.rgb + light * (1.0 - color.rgb), color.a);
}

// Weighted mean of the pixels along a direction, as far as `radius`.
fn NAME_mean(at: ImageAt, along: vec2i, radius: f32) -> vec4f {
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
