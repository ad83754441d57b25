// Dots: draws dots along edges or a polyline.

struct Dots {
    /// Color of the dots, linear; its alpha is their strength.
    @color(1, 0.55, 0.15) color: vec4f,
    /// The lines along which dots are drawn.
    @choice(edges, creases, polyline) lines: u32,
    /// The least angle between two faces that counts as a crease.
    @range(1, 90, 25) @hard(0, 180) @unit(°) @when(lines, creases) crease_deg: f32,
    /// Distance from dot to dot along the line.
    @range(0.001, 10, 0.05) @hard(1e-05, 1000) @unit(m) @log spacing_m: f32,
    /// Diameter of the dots.
    @range(1, 16, 2.5) @hard(1, 128) @unit(px) size_px: f32,
    /// The gap on the screen below which every second dot begins to fade.
    @range(1, 64, 6) @hard(0.25, 1024) @unit(px) @log min_gap_px: f32,
    /// How often the dots may be halved; 0: all are drawn, however dense.
    @range(0, 24, 20) levels: u32,
    /// Fraction of the distance from one halving to the next over which dots fade.
    @range(0.0625, 1, 1) fade: f32,
    /// Strength of dots behind the model, relative to visible ones.
    @range(0, 1, 0.2) hidden_opacity: f32,
    /// How far behind the surface a dot still counts as on it, as a fraction of its distance.
    @range(0.0001, 0.1, 0.01) @hard(0, 0.5) @log bias: f32,
    /// The model shows beneath the dots; without it, it only hides them.
    @toggle(1) show_model: u32,
    /// Length of a dash of dots, at least their distance; 0: the line has dots all along.
    @range(0, 2, 0) @hard(0, 1000) @unit(m) dash_m: f32,
    /// Gap between two dashes. Both are stretched alike so that a line begins and ends with a whole dash.
    @range(0, 2, 0.1) @hard(0, 1000) @unit(m) gap_m: f32,
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
