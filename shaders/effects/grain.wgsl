// Grain: the noise of a photographic film. It is strongest in the middle tones.
//@ use lib/image_pass
//@ use lib/color
//@ use lib/hash

struct Grain {
    /// Strength of the noise.
    @range(0, 1, 0.35) amount: f32,
    /// How far red, green and blue have noise of their own.
    @range(0, 1, 0.25) color: f32,
    /// Size of a grain.
    @range(1, 8, 1) @hard(1, 64) @unit(px) size_px: u32,
    /// Another seed gives other noise.
    @range(0, 65535, 0) seed: u32,
}

fn grain(at: ImageAt, p: Grain) -> vec4f {
    let size = i32(p.size_px);
    let cell = vec2u(vec2i(at.x, at.y) / size);
    let seed = hash(hash(cell.x + p.seed * HASH_GOLDEN) + cell.y);
    let gray = grain_noise(seed);
    let own = vec3f(grain_noise(seed + 1u), grain_noise(seed + 2u), grain_noise(seed + 3u));
    let noise = mix(vec3f(gray), own, p.color);
    let color = image_color(at.x, at.y);
    // Square roots are about what the eye sees.
    let tone = sqrt(clamp(color.rgb, vec3f(0.0), vec3f(1.0)));
    let middle = sqrt(clamp(color_luminance(color.rgb), 0.0, 1.0));
    let strength = p.amount * (0.25 + 3.0 * middle * (1.0 - middle));
    let grained = clamp(tone + strength * noise, vec3f(0.0), vec3f(1.0));
    return vec4f(grained * grained, color.a);
}

// A sum of three numbers, about normally distributed, -1/2 to 1/2.
fn grain_noise(seed: u32) -> f32 {
    let sum = hash_unit(seed) + hash_unit(seed ^ 0x55555555u) + hash_unit(seed ^ 0x33333333u);
    return sum / 3.0 - 0.5;
}
