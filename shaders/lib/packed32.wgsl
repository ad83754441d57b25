// Depth key and complemented triangle id in one word. The id takes the bits that the scene's number of triangles needs; the
// key takes the others, and loses its lowest bits. Keys below MIN_DEPTH_KEY count as the farthest.

// Bits of a triangle id.
override ID_BITS: u32 = 16u;
// Bits of a key before it is cut, once the least key is subtracted.
override DEPTH_KEY_BITS: u32 = 28u;
override MIN_DEPTH_KEY: u32 = 0u;

// Bits that a key loses.
fn packed32_lost_bits() -> u32 {
    return max(DEPTH_KEY_BITS + ID_BITS, 32u) - 32u;
}

fn packed32_word(key: u32, id: u32) -> u32 {
    return (((max(key, MIN_DEPTH_KEY) - MIN_DEPTH_KEY) >> packed32_lost_bits()) << ID_BITS) | (~id & ((1u << ID_BITS) - 1u));
}

// Complemented id and key of a word that is not 0.
fn packed32_unpacked(word: u32) -> vec2u {
    return vec2u(word | ~((1u << ID_BITS) - 1u), max(((word >> ID_BITS) << packed32_lost_bits()) + MIN_DEPTH_KEY, 1u));
}
