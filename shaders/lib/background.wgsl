// The background of the picture: one color, or one for every row.
//@ use lib/frame
//@ use lib/picture

// The rows of a gradient are bytes that the CPU computed, so that they are the same on every adapter.
fn background_of_row(y: u32) -> vec4f {
    if frame.background_first <= y { return frame.background; }
    let word = color[frame.background_first + y];
    return vec4f((vec4u(word) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u)) / 255.0;
}
