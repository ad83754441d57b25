// Framebuffer reads: triangle id and depth key of a pixel, once all raster passes have run.
// Chosen by the layout of the framebuffer (accuracy axis `visibility`). Default: split32.
//
// x: complemented triangle id, 0 for an empty pixel. y: depth key, as far as it is kept.
//@ declare fn framebuffer_load(pixel: u32) -> vec2u
// A word behind the last pixel.
//@ declare fn framebuffer_load_behind(word: u32) -> u32

//@ variant split32
// Two buffers of words.
//@ use lib/frame

@group(0) @binding(5) var<storage, read> depth_keys: array<u32>;
@group(0) @binding(6) var<storage, read> triangle_ids: array<u32>;

fn framebuffer_load(pixel: u32) -> vec2u {
    return vec2u(triangle_ids[pixel], depth_keys[pixel]);
}

fn framebuffer_load_behind(word: u32) -> u32 {
    return depth_keys[frame.size.x * frame.size.y + word];
}

//@ variant packed32
// One word per pixel.
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

//@ variant packed64
// The halves of a 64-bit word per pixel.
//@ use lib/frame

@group(0) @binding(5) var<storage, read> depth_and_id: array<vec2u>;

fn framebuffer_load(pixel: u32) -> vec2u {
    return depth_and_id[pixel];
}

fn framebuffer_load_behind(word: u32) -> u32 {
    let pair = depth_and_id[frame.size.x * frame.size.y + word / 2u];
    return select(pair.x, pair.y, (word & 1u) != 0u);
}

//@ variant packed64_wide
// A 64-bit word per pixel in one load, for adapters whose loads take one component at a time.
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
