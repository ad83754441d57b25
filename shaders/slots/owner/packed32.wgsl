// Triangle id of a finished pixel, from packed32's word.
//@ use common/packed

@group(0) @binding(5) var<storage, read> packed: array<u32>;

// x: complemented id, 0 where empty. y: depth key, as much as is left of it.
fn owner_load(pixel: u32) -> vec2u {
    let word = packed[pixel];
    return select(packed_parts(word), vec2u(0u), word == 0u);
}

// A word of what stands behind the last pixel.
fn triangle_beyond(word: u32) -> u32 {
    return packed[frame.size.x * frame.size.y + word];
}
