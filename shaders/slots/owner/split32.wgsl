// Triangle id of a finished pixel, from the two buffers of split32.

@group(0) @binding(5) var<storage, read> depth_keys: array<u32>;
@group(0) @binding(6) var<storage, read> triangle_ids: array<u32>;

// x: complemented id, 0 where empty. y: depth key.
fn owner_load(pixel: u32) -> vec2u {
    return vec2u(triangle_ids[pixel], depth_keys[pixel]);
}

// A word of what stands behind the last pixel.
fn triangle_beyond(word: u32) -> u32 {
    return depth_keys[frame.size.x * frame.size.y + word];
}
