// Dither: ordered dithering (Bayer 1973), so that few levels look like many.
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
    let threshold = (f32(dither_rank(q.x / p.cell_px, q.y / p.cell_px, bits)) + 0.5) / f32(1u << (2u * bits));
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

// Rank of a cell in the order in which a matrix with a side of 2^bits fills up: for every bit, the checkerboard first.
fn dither_rank(x: u32, y: u32, bits: u32) -> u32 {
    var rank = 0u;
    for (var bit = 0u; bit < bits; bit += 1u) {
        rank = (rank << 2u) | ((((x ^ y) >> bit) & 1u) << 1u) | ((y >> bit) & 1u);
    }
    return rank;
}
