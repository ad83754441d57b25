// Triangle id of a finished pixel, from the halves of packed64's words.

@group(0) @binding(5) var<storage, read> depth_and_id: array<vec2u>;

// x: complemented id, 0 where empty. y: depth key.
fn owner_load(pixel: u32) -> vec2u {
    return depth_and_id[pixel];
}

// A word of what stands behind the last pixel.
fn triangle_beyond(word: u32) -> u32 {
    let pair = depth_and_id[frame.size.x * frame.size.y + word / 2u];
    return select(pair.x, pair.y, (word & 1u) != 0u);
}
