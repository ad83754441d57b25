// Framebuffer reads, packed64: the halves of a 64-bit word per pixel.
//@ use lib/frame

@group(0) @binding(5) var<storage, read> depth_and_id: array<vec2u>;

fn framebuffer_load(pixel: u32) -> vec2u {
    return depth_and_id[pixel];
}

fn framebuffer_load_behind(word: u32) -> u32 {
    let pair = depth_and_id[frame.size.x * frame.size.y + word / 2u];
    return select(pair.x, pair.y, (word & 1u) != 0u);
}
