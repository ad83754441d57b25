// Bloom: bright places shine over their surroundings.
//@ use lib/image_pass

struct Bloom {
    /// Color of the light, linear; its alpha is the strength.
    @color(1, 0.93, 0.82) tint: vec4f,
    /// Brightness from which a place shines, linear.
    @range(0, 1, 0.4) threshold: f32,
    /// How far above it a place shines entirely.
    @range(0.01, 1, 0.35) knee: f32,
    /// How far the light reaches.
    @range(1, 96, 36) @hard(1, 512) @unit(px) radius_px: f32,
    /// Strength of the light.
    @range(0, 4, 1.4) @hard(0, 16) intensity: f32,
}

// What shines, at half the size.
@pass(half)
fn bloom_bright(at: ImageAt, p: Bloom) -> vec4f {
    let middle = image_middle(at);
    let color = image_color_at(middle.x, middle.y);
    let brightest = max(max(color.r, color.g), color.b);
    let past = clamp((brightest - p.threshold) / p.knee, 0.0, 1.0);
    return vec4f(color.rgb * (past * past * (3.0 - 2.0 * past)), color.a);
}

@pass(half)
fn bloom_across(at: ImageAt, p: Bloom) -> vec4f {
    return bloom_along(at, vec2i(1, 0), 0.5 * p.radius_px);
}

@pass(half)
fn bloom_down(at: ImageAt, p: Bloom) -> vec4f {
    return bloom_along(at, vec2i(0, 1), 0.5 * p.radius_px);
}

// Light over light, as two projectors screen it.
fn bloom_screen(at: ImageAt, p: Bloom) -> vec4f {
    let color = image_color(at.x, at.y);
    let middle = 0.5 * image_middle(at);
    let shine = p.intensity * p.tint.a * p.tint.rgb * image_last_at(middle.x, middle.y).rgb;
    return vec4f(color.rgb + shine * (1.0 - clamp(color.rgb, vec3f(0.0), vec3f(1.0))), color.a);
}

// Weighted mean of the pixels along a direction: a sharp core in a wide halo.
fn bloom_along(at: ImageAt, along: vec2i, radius: f32) -> vec4f {
    let reach = i32(ceil(radius));
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = -reach; i <= reach; i += 1) {
        let t = f32(i) / (radius + 1.0);
        let near = max(1.0 - abs(t), 0.0);
        let weight = near * near * near;
        sum += weight * image_last(at.x + i * along.x, at.y + i * along.y);
        weights += weight;
    }
    return sum / weights;
}
