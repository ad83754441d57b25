// Depth, log24: 24 bits of a float's own logarithm: five of the exponent, 2^-31 to 1, and nineteen of the fraction.

const LOG_FIRST = 0x30000000u; // 2^-31
const LOG_STEP = 16u;

// Key of a reversed depth from 0 to 1: larger is nearer, at least 1.
fn depth_key(z: f32) -> u32 {
    return max(max(bitcast<u32>(z), LOG_FIRST) - LOG_FIRST, LOG_STEP) / LOG_STEP;
}

// Bits of the reversed depth that a key stands for.
fn depth_bits(key: u32) -> u32 {
    return LOG_FIRST + key * LOG_STEP;
}
