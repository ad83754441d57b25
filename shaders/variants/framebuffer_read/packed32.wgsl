// Framebuffer reads, packed32: one word per pixel.
//@ use lib/frame
//@ use lib/packed32

@group(0) @binding(5) var<storage, read> packed: array<u32>;

fn framebuffer_load(pixel: u32) -> vec2u {
    let word = packed[pixel];
    return select(packed32_unpacked(word), vec2u(0u), word == 0u);
}

fn framebuffer_load_behind(word: u32) -> u32 {
    return packed[frame.size.x * frame.size.y + word];
}
