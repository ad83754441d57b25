// Owner of a finished pixel, from the halves of packed64's words.

@group(0) @binding(5) var<storage, read> depth_owner: array<vec2u>;

// x: complemented id, 0 where empty. y: depth key.
fn owner_load(pixel: u32) -> vec2u {
    return depth_owner[pixel];
}

// A word of what stands behind the last pixel.
fn owner_beyond(word: u32) -> u32 {
    let pair = depth_owner[frame.size.x * frame.size.y + word / 2u];
    return select(pair.x, pair.y, (word & 1u) != 0u);
}
