// CRT: a curved screen with scan lines and stripes of red, green and blue phosphor.
//@ use lib/angle
//@ use lib/image
//@ use lib/image_pass

struct Crt {
    curve: f32,
    lines: f32,
    line_px: f32,
    mask: f32,
    mask_px: u32,
    soft_px: f32,
    gain: f32,
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
