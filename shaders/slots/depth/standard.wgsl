// Depth, standard: a float that is 0 at the near plane and 1 far away, turned round so that larger is nearer. Its bits crowd
// where nothing is.

// Key of a reversed depth from 0 to 1: larger is nearer, at least 1.
fn depth_key(z: f32) -> u32 {
    return 0x3f800001u - bitcast<u32>(clamp(1.0 - z, 0.0, 1.0));
}

// Bits of the reversed depth that a key stands for.
fn depth_bits(key: u32) -> u32 {
    return bitcast<u32>(1.0 - bitcast<f32>(0x3f800001u - key));
}
