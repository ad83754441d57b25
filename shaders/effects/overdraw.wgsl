// Overdraw: paints how many layers each pixel has, as heat.

struct Overdraw {
    /// Layers at full heat; more look the same.
    @range(1, 100, 12) @hard(1, 1e9) @log max_layers: u32,
    /// How layers become heat.
    @choice(linear, log) scale: u32,
    /// The colors of heat.
    @choice(ember, reef, grey) palette: u32,
}

// Colors from cold to hot at equal steps of heat, gamma-encoded, red in the lowest byte: ember, reef, gray.
const OVERDRAW_STOPS = array<u32, 27>(
    0x3a1416u, 0x691a3eu, 0x821f70u, 0x8428a5u, 0x733bd7u, 0x565cf9u, 0x4293fcu, 0x4dc0fdu, 0x94e8fcu,
    0x4a1234u, 0x6d2d39u, 0x804d2fu, 0x896b24u, 0x89891cu, 0x7da728u, 0x60c35cu, 0x3cd8a6u, 0x3ce6f6u,
    0x1c1c1cu, 0x383838u, 0x545454u, 0x717171u, 0x8d8d8du, 0xaaaaaau, 0xc6c6c6u, 0xe3e3e3u, 0xffffffu);

// Heat of a number of layers: 0 for one, 1 at full heat.
fn overdraw_heat(layers: u32, p: Overdraw) -> f32 {
    let count = f32(max(layers, 1u));
    let full = f32(max(p.max_layers, 2u));
    let heat = select((count - 1.0) / (full - 1.0), log2(count) / log2(full), p.scale == OVERDRAW_SCALE_LOG);
    return min(heat, 1.0);
}

// Color of a heat from 0 to 1, gamma-encoded.
fn overdraw_color(heat: f32, p: Overdraw) -> vec3f {
    var stops = OVERDRAW_STOPS;
    let position = clamp(heat, 0.0, 1.0) * 8.0;
    let first = min(u32(position), 7u);
    let low = unpack4x8unorm(stops[p.palette * 9u + first]).rgb;
    let high = unpack4x8unorm(stops[p.palette * 9u + first + 1u]).rgb;
    return low + (high - low) * (position - f32(first));
}
