// Dither: ordered dithering, so that few levels look like many. The matrix is Bayer's (1973).
//@ use lib/bayer
//@ use lib/image
//@ use lib/color

struct Dither {
    /// Color of the lowest level, linear.
    @color(0.02, 0.03, 0.05) @when(palette, duotone) ink: vec4f,
    /// Color of the highest level, linear.
    @color(0.8, 0.82, 0.7) @when(palette, duotone) paper: vec4f,
    /// Number of levels, lowest and highest included.
    @range(2, 256, 256) levels: u32,
    /// Which colors the levels have.
    @choice(rgb, duotone) palette: u32,
    /// Size of the matrix.
    @choice(bayer8, bayer4, bayer2) matrix: u32,
    /// Side of a cell of the matrix.
    @range(1, 8, 1) @hard(1, 1024) @unit(px) cell_px: u32,
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
