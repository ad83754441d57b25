// Dither: ordered dithering (Bayer 1973), so that few levels look like many.
//@ use lib/bayer
//@ use lib/image
//@ use lib/color

struct Dither {
    ink: vec4f,
    paper: vec4f,
    levels: u32,
    palette: u32,
    matrix: u32,
    cell_px: u32,
}

fn dither(pixel: Pixel, p: Dither) -> Pixel {
    var q = pixel;
    let bits = 3u - p.matrix;
    let threshold = (f32(bayer_rank(q.x / p.cell_px, q.y / p.cell_px, bits)) + 0.5) / f32(1u << (2u * bits));
    let last = f32(p.levels - 1u);
    let base = q.color.rgb;
    var value = base;
    if p.palette == DITHER_PALETTE_DUOTONE { value = vec3f(color_luminance(base)); }
    let level = clamp(floor(value * last + threshold) / last, vec3f(0.0), vec3f(1.0));
    var color = level;
    if p.palette == DITHER_PALETTE_DUOTONE {
        let ink = color_encode(p.ink.rgb);
        color = ink + (color_encode(p.paper.rgb) - ink) * level;
    }
    q.color = vec4f(color, q.color.a);
    return q;
}
