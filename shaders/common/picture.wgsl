// The picture: packed pixels, `stride` a row. Behind them, where tiles are listed, stands the list: portable devices bind
// eight storage buffers to a pass, and the resolve has no ninth for it.
//@ use common/frame

@group(0) @binding(11) var<storage, read_write> color: array<u32>;

fn picture_first_listed() -> u32 {
    return frame.stride * frame.size.y;
}
