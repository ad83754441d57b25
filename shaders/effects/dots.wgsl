// Dots: draws dots along the edges of the meshes, or along a polyline, evenly spaced in the world.

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
    dash_m: f32,
    gap_m: f32,
}

const DOTS_FULL = 256u;
const DOTS_STEPS = 23u;

// How often the gap has halved, in steps of 2^-23, for the bits of 1/w: bits of a float rise by 2^23 when it doubles.
fn dots_halved(inv_w: u32, fade_from: u32, levels: u32) -> u32 {
    return u32(clamp(i32(fade_from) - i32(inv_w), 0, i32(levels << DOTS_STEPS)));
}

// Strength of the dot of this number, 0 to DOTS_FULL.
fn dots_strength(number: u32, halved: u32, fade_rate: u32) -> u32 {
    // The number 0 has no last bit, which compares as more than any level.
    let level = firstTrailingBit(number);
    let shown_level = halved >> DOTS_STEPS;
    let left = (1u << DOTS_STEPS) - (halved & ((1u << DOTS_STEPS) - 1u));
    let fading = min(((left >> 8u) * fade_rate) >> (DOTS_STEPS - 8u), DOTS_FULL);
    return select(select(0u, fading, level == shown_level), DOTS_FULL, level > shown_level);
}

// Coverage of a pixel, 0 to DOTS_FULL, by a dot whose center lies at distance d from the sample, in units of 1/256 px: one half at
// the radius.
fn dots_cover(d: vec2i, radius: u32) -> u32 {
    let squared = d.x * d.x + d.y * d.y;
    return min(u32(max(i32((radius + 256u) * radius) - squared, 0)) / (2u * radius), DOTS_FULL);
}
