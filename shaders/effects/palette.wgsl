// Palette: every pixel takes the nearest of a few inks, dithered.
//@ use lib/bayer
//@ use lib/color
//@ use lib/image_pass

struct Palette {
    /// The inks.
    @choice(handheld, cga, ember, arcade) @default(arcade) inks: u32,
    /// How far a 4 by 4 matrix moves colors apart before each takes its ink, of black to white.
    @range(0, 1, 0.12) dither: f32,
    /// Side of a cell of the matrix.
    @range(1, 8, 1) @hard(1, 1024) @unit(px) cell_px: u32,
}

// Inks, gamma-encoded, red in the lowest byte: handheld, cga, ember, arcade.
const PALETTE_INKS = array<u32, 32>(
    0x0f380fu, 0x306230u, 0x0fac8bu, 0x0fbc9bu,
    0x000000u, 0xffff55u, 0xff55ffu, 0xffffffu,
    0x140b0du, 0x30153bu, 0x3d1f7au, 0x343bbfu, 0x3b74e8u, 0x5ab2f6u, 0xa0e3fbu, 0xeafbffu,
    0x1f1316u, 0x4f2e3au, 0x63446eu, 0x5a43b0u, 0x4a70e0u, 0x5eb2f2u, 0xa1e3f7u, 0xeff7fbu,
    0xb5a79au, 0x806b5cu, 0x6f4a2bu, 0xc08f3fu, 0xd8d68fu, 0x4f6b2fu, 0x5aae6fu, 0x4b69a0u);
// Where each list begins, and the end of the last.
const PALETTE_STARTS = array<u32, 5>(0u, 4u, 8u, 16u, 32u);

fn palette(at: ImageAt, p: Palette) -> vec4f {
    let color = image_color(at.x, at.y);
    let cell = vec2u(vec2i(at.x, at.y)) / p.cell_px;
    let threshold = (f32(bayer_rank(cell.x, cell.y, 2u)) + 0.5) / 16.0 - 0.5;
    let wanted = color_encode(color.rgb) + vec3f(threshold * p.dither);
    var starts = PALETTE_STARTS;
    var inks = PALETTE_INKS;
    var nearest = vec3f(0.0);
    var least = 1e9;
    for (var i = starts[p.inks]; i < starts[p.inks + 1u]; i += 1u) {
        let ink = unpack4x8unorm(inks[i]).rgb;
        let distance = palette_distance(wanted, ink);
        if distance < least {
            least = distance;
            nearest = ink;
        }
    }
    return vec4f(color_decode(nearest), color.a);
}

// How different two gamma-encoded colors look, squared: brightness counts beside what the channels differ by.
fn palette_distance(a: vec3f, b: vec3f) -> f32 {
    let apart = a - b;
    let weighted = apart * vec3f(0.299, 0.587, 0.114);
    let brightness = weighted.r + weighted.g + weighted.b;
    return 0.75 * dot(weighted, apart) + brightness * brightness;
}
