// CRT: a curved screen with scan lines and phosphor stripes.
//@ use lib/angle
//@ use lib/image
//@ use lib/image_pass

struct Crt {
    /// How much the screen bulges: 0 is flat.
    @range(0, 0.4, 0.07) @hard(0, 1) curve: f32,
    /// How dark it is between scan lines.
    @range(0, 1, 0.6) lines: f32,
    /// Distance of scan lines.
    @range(2, 12, 3) @hard(1, 64) @unit(px) line_px: f32,
    /// How much light of other colors the stripes of phosphor keep back.
    @range(0, 1, 0.35) mask: f32,
    /// Width of a red, a green and a blue stripe together.
    @range(3, 24, 3) @hard(3, 96) @unit(px) mask_px: u32,
    /// How far the beam spreads along a line.
    @range(0, 4, 0.8) @hard(0, 32) @unit(px) soft_px: f32,
    /// Brightness, which makes up for lines and stripes.
    @range(0.5, 3, 1.6) @hard(0, 8) gain: f32,
}

fn crt(at: ImageAt, p: Crt) -> vec4f {
    let size = vec2f(image_size());
    let flat = (image_middle(at) - 0.5 * size) / (0.5 * size);
    let bent = flat * (1.0 + p.curve * flat.yx * flat.yx);
    let place = (0.5 + 0.5 * bent) * size;
    // The beam is wide, across the lines.
    var light = 0.5 * image_color_at(place.x, place.y).rgb;
    light += 0.25 * image_color_at(place.x - p.soft_px, place.y).rgb;
    light += 0.25 * image_color_at(place.x + p.soft_px, place.y).rgb;
    let beam = 0.5 - 0.5 * cosine_turns(place.y / p.line_px);
    let stripe = (u32(at.x) * 3u / p.mask_px) % 3u;
    let own = vec3f(vec3<bool>(stripe == 0u, stripe == 1u, stripe == 2u));
    let phosphor = 1.0 - p.mask * (1.0 - own);
    // The rim of the screen, a pixel wide.
    let inside = clamp((1.0 - abs(bent)) * 0.5 * size + 0.5, vec2f(0.0), vec2f(1.0));
    let shown = p.gain * inside.x * inside.y * (1.0 - p.lines * (1.0 - beam));
    return vec4f(light * phosphor * shown, image_color(at.x, at.y).a);
}
