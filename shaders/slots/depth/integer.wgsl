// Depth, integer: keys look like the bits of a float that is 1 at the near plane and 0 far away; at a corner they are those.

// Key of a reversed depth from 0 to 1: larger is nearer, at least 1.
fn depth_key(z: f32) -> u32 {
    return max(bitcast<u32>(z), 1u);
}

// Bits of the reversed depth that a key stands for.
fn depth_bits(key: u32) -> u32 {
    return key;
}
