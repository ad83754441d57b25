// Two prints: dark parts are printed from one sheet, bright ones from another, as with plates for shadow and light.
//@ use lib/color

struct TwoPrints {
    /// Sheet of the dark parts.
    @image("grain.png") dark: u32,
    /// Colors of the bright parts.
    @image("ramp.png") bright: u32,
    /// Where they meet.
    @range(0.1, 0.9, 0.5) middle: f32,
}

fn two_prints(at: ImageAt, p: TwoPrints) -> vec4f {
    let color = image_color(at.x, at.y);
    let light = sqrt(clamp(color_luminance(color.rgb), 0.0001, 1.0));
    let texel = image_file_texel(p.dark, (2 * at.x) % 16, (2 * at.y) % 16).rgb;
    let dark = texel * light;
    let bright = image_file_at(p.bright, vec2f(light, 0.5)).rgb;
    let weight = clamp((light - p.middle) * 4.0 + 0.5, 0.0, 1.0);
    return vec4f(mix(dark, bright, weight), color.a);
}
