// Depth, ndc16: 16 bits, evenly spaced in normalized device depth.

// Key of a reversed depth from 0 to 1: larger is nearer, at least 1.
fn depth_key(z: f32) -> u32 {
    return max(u32(clamp(z, 0.0, 1.0) * 65535.0 + 0.5), 1u);
}

// Bits of the reversed depth that a key stands for.
fn depth_bits(key: u32) -> u32 {
    return bitcast<u32>(f32(key) / 65535.0);
}
