// Old film: brown, grainy, scratched and dark in the corners.
//@ use lib/color
//@ use lib/hash

struct OldFilm {
    /// Color of the silver.
    @color(1.0, 0.8, 0.55) tint: vec4f,
    /// Strength of the grain.
    @range(0.0, 1.0, 0.3) grain: f32,
    /// One column in so many has a scratch.
    @range(4, 200, 24) scratches: u32,
    /// Number of the picture.
    @range(0, 1000, 7) picture: u32,
}

fn old_film(at: ImageAt, p: OldFilm) -> vec4f {
    let color = image_color(at.x, at.y);
    let dust = hash_unit(hash(u32(at.x) + p.picture * 7919u) + u32(at.y)) - 0.5;
    var light = color_luminance(color.rgb) * (1.0 + p.grain * dust);
    if hash(u32(at.x) + p.picture * 104729u) % p.scratches == 0u {
        light += 0.15;
    }
    let away = image_middle(at) / vec2f(at.size) - 0.5;
    light *= 1.0 - dot(away, away);
    return vec4f(p.tint.rgb * max(light, 0.0), color.a);
}
