// Miniature: sharp only in a band, and colorful, as a photograph of a model railway.
//@ use lib/color

struct Miniature {
    /// Where the band lies, 0 at the top.
    @range(0.0, 1.0, 0.55) band: f32,
    /// Half of its height.
    @range(0.02, 0.5, 0.15) width: f32,
    /// How far the rest is blurred.
    @range(1.0, 16.0, 6.0) @unit(px) radius_px: f32,
    /// How colorful.
    @range(0.0, 2.0, 1.3) saturation: f32,
}

fn mean(at: ImageAt, along: vec2i, p: Miniature) -> vec4f {
    let height = (f32(at.y) + 0.5) / f32(at.size.y);
    let radius = p.radius_px * clamp((abs(height - p.band) - p.width) / p.width, 0.0, 1.0);
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = -16; i <= 16; i++) {
        let weight = clamp(radius + 1.0 - f32(abs(i)), 0.0, 1.0);
        sum += weight * image_last(at.x + i * along.x, at.y + i * along.y);
        weights += weight;
    }
    return sum / weights;
}

fn across(at: ImageAt, p: Miniature) -> vec4f {
    return mean(at, vec2i(1, 0), p);
}

fn down(at: ImageAt, p: Miniature) -> vec4f {
    let color = mean(at, vec2i(0, 1), p);
    return vec4f(max(mix(vec3f(color_luminance(color.rgb)), color.rgb, p.saturation), vec3f(0.0)), color.a);
}
