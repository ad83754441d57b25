// Framebuffer reads, split32: two buffers of words.
//@ use lib/frame

@group(0) @binding(5) var<storage, read> depth_keys: array<u32>;
@group(0) @binding(6) var<storage, read> triangle_ids: array<u32>;

fn framebuffer_load(pixel: u32) -> vec2u {
    return vec2u(triangle_ids[pixel], depth_keys[pixel]);
}

fn framebuffer_load_behind(word: u32) -> u32 {
    return depth_keys[frame.size.x * frame.size.y + word];
}
