// Posterize: few levels of color, evenly spaced to the eye.
//@ use lib/image

struct Posterize {
    /// What is quantized.
    @choice(channels, brightness) by: u32,
    /// Number of levels, black and white included.
    @range(2, 16, 5) @hard(2, 256) levels: u32,
    /// How far colors move to their level: 0 not at all, 1 entirely.
    @range(0, 1, 1) amount: f32,
}

fn posterize(pixel: Pixel, p: Posterize) -> Pixel {
    var q = pixel;
    let last = f32(p.levels - 1u);
    let base = q.color.rgb;
    var flat = clamp(floor(base * last + 0.5) / last, vec3f(0.0), vec3f(1.0));
    if p.by == POSTERIZE_BY_BRIGHTNESS {
        let brightest = max(max(base.r, base.g), base.b);
        flat = base * (clamp(floor(brightest * last + 0.5) / last, 0.0, 1.0) / max(brightest, 1e-6));
    }
    q.color = vec4f(base + (flat - base) * p.amount, q.color.a);
    return q;
}
