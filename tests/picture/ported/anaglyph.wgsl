// Anaglyph: a red and a cyan picture, apart by depth, for glasses of two colors.
//@ use lib/color

struct Anaglyph {
    /// How far apart the pictures are in the foreground.
    @range(0.0, 32.0, 8.0) @unit(px) apart_px: f32,
    /// Depth at which they meet.
    @range(0.5, 50.0, 4.0) meet: f32,
}

fn anaglyph(at: ImageAt, p: Anaglyph) -> vec4f {
    let depth = min(image_depth_m(at.x, at.y), 100.0 * p.meet);
    let shift = clamp(p.apart_px * (p.meet / depth - 1.0), -p.apart_px, p.apart_px);
    let middle = image_middle(at);
    let left = image_color_at(middle.x - 0.5 * shift, middle.y);
    let right = image_color_at(middle.x + 0.5 * shift, middle.y);
    return vec4f(color_luminance(left.rgb), right.g, right.b, image_color(at.x, at.y).a);
}
