// The picture: packed pixels, `stride` a row. Behind them stands the list, where tiles are listed, or the strength of dots
// on every pixel, where there are dots: portable devices bind eight storage buffers to a pass, and the resolve has no ninth.
//@ use common/frame

@group(0) @binding(11) var<storage, read_write> color: array<u32>;

fn picture_first_listed() -> u32 {
    return frame.stride * frame.size.y;
}

fn picture_first_dot() -> u32 {
    return frame.stride * frame.size.y;
}
