// The picture: packed pixels, `frame.stride` per row. Behind the pixels stand the strength of dots on every pixel if there are dots, then
// the list of tiles, and behind those the background of every row if that is a gradient: portable adapters bind eight storage buffers to
// a pass, and the resolve pass has no ninth.
//@ use lib/frame
//@ binding @group(0) @binding(11) var<storage, read_write> color: array<u32>;

override HAS_DOT_STRENGTHS: bool = false;

// First word of the list of tiles.
fn tile_list() -> u32 {
    return color_end() + select(0u, frame.size.x * frame.size.y, HAS_DOT_STRENGTHS);
}

// Gamma-encoded background of the pixel that is resolved. The resolve pass sets it first.
var<private> background: vec4f;

// The rows of a gradient are bytes that the CPU computed, so that they are the same on every adapter.
fn background_of_row(y: u32) -> vec4f {
    if frame.background_first <= y { return frame.background; }
    let word = color[frame.background_first + y];
    return vec4f((vec4u(word) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u)) / 255.0;
}
