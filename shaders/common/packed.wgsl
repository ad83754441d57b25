// Packed: key and complemented id in one word. The id takes the bits that the scene's number of triangles needs, the key has
// the rest: what it cannot hold is cut off below. Keys of depths too far away to tell apart count as the farthest.

// Bits of an id.
override ID_BITS: u32 = 16u;
// Bits that a key has before it is cut, once the least is taken off.
override DEPTH_KEY_BITS: u32 = 28u;
override MIN_DEPTH_KEY: u32 = 0u;

// Bits that a key loses.
fn packed_loss() -> u32 {
    return max(DEPTH_KEY_BITS + ID_BITS, 32u) - 32u;
}

fn packed_word(key: u32, id: u32) -> u32 {
    return (((max(key, MIN_DEPTH_KEY) - MIN_DEPTH_KEY) >> packed_loss()) << ID_BITS) | (~id & ((1u << ID_BITS) - 1u));
}

// Complemented id and key of a word that is not 0.
fn packed_parts(word: u32) -> vec2u {
    return vec2u(word | ~((1u << ID_BITS) - 1u), max(((word >> ID_BITS) << packed_loss()) + MIN_DEPTH_KEY, 1u));
}
