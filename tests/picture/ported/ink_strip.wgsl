// Ink strip: the brightness of a pixel chooses its color from a strip of inks.
//@ use lib/color

struct InkStrip {
    /// A strip from dark to bright.
    @image("palette.png") strip: u32,
    /// How much of the strip is seen.
    @range(0.0, 1.0, 1.0) amount: f32,
    /// Brightness that chooses the middle of the strip.
    @range(0.05, 0.95, 0.5) middle: f32,
}

fn ink_strip(at: ImageAt, p: InkStrip) -> vec4f {
    let color = image_color(at.x, at.y);
    let light = sqrt(clamp(color_luminance(color.rgb), 0.0001, 1.0));
    // A curve through (0, 0), (middle, 1/2) and (1, 1).
    let place = light * (1.0 - p.middle) / (p.middle + light * (1.0 - 2.0 * p.middle));
    let ink = image_file_at(p.strip, vec2f(place, 0.5)).rgb;
    return vec4f(mix(color.rgb, ink, p.amount), color.a);
}
