// Dots: strings dots along the edges of the meshes, or along a polyline, evenly in the world.

struct Dots {
    color: vec4f,
    lines: u32,
    crease_deg: f32,
    spacing_m: f32,
    size_px: f32,
    min_gap_px: f32,
    levels: u32,
    fade: f32,
    hidden_opacity: f32,
    bias: f32,
    show_model: u32,
}

const DOTS_FULL = 256u;
const DOTS_STEPS = 23u;

// How often the gap has halved, in steps of 2^-23, where 1/w has these bits: bits of floats rise by one level when the float
// doubles.
fn dots_halved(inv_w: u32, fade_from: u32, levels: u32) -> u32 {
    return u32(clamp(i32(fade_from) - i32(inv_w), 0, i32(levels << DOTS_STEPS)));
}

// Strength of the dot of this number, 0 to DOTS_FULL.
fn dots_strength(number: u32, halved: u32, fade_rate: u32) -> u32 {
    // The number 0 has no last bit, which reads as more than any level.
    let level = firstTrailingBit(number);
    let wanted = halved >> DOTS_STEPS;
    let left = (1u << DOTS_STEPS) - (halved & ((1u << DOTS_STEPS) - 1u));
    let fading = min(((left >> 8u) * fade_rate) >> (DOTS_STEPS - 8u), DOTS_FULL);
    return select(select(0u, fading, level == wanted), DOTS_FULL, level > wanted);
}

// Share of a pixel that a dot covers whose middle is so far from the sample, in units of 1/256 px: half of it at the radius.
fn dots_cover(d: vec2i, radius: u32) -> u32 {
    let squared = d.x * d.x + d.y * d.y;
    return min(u32(max(i32((radius + 256u) * radius) - squared, 0)) / (2u * radius), DOTS_FULL);
}
