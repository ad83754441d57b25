// Framebuffer reads, packed64_wide: a 64-bit word per pixel in one load, for adapters whose loads take one component at a time.
//@ use lib/frame

@group(0) @binding(5) var<storage, read> depth_and_id: array<u64>;

fn framebuffer_load(pixel: u32) -> vec2u {
    return framebuffer_halves(depth_and_id[pixel]);
}

fn framebuffer_load_behind(word: u32) -> u32 {
    let halves = framebuffer_halves(depth_and_id[frame.size.x * frame.size.y + word / 2u]);
    return select(halves.x, halves.y, (word & 1u) != 0u);
}

fn framebuffer_halves(pair: u64) -> vec2u {
    return vec2u(u32(pair & 0xfffffffflu), u32(pair >> 32u));
}
