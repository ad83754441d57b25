// The picture: packed pixels, `frame.stride` per row. Behind the pixels stands the list of marked tiles, or the strength of dots on
// every pixel, and behind those the background of every row if that is a gradient: portable adapters bind eight storage buffers to a
// pass, and the resolve pass has no ninth.
//@ use lib/frame
//@ binding @group(0) @binding(11) var<storage, read_write> color: array<u32>;

// Word of the picture behind its last row.
fn color_end() -> u32 {
    return frame.stride * frame.size.y;
}

// Gamma-encoded background of the pixel that is resolved. The resolve pass sets it first.
var<private> background: vec4f;
