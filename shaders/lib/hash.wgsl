// Integer hash with full avalanche (Ettinger and Wellons, "lowbias32"); a bijection of u32.

// 2^32 over the golden ratio: what seeds are multiplied by, so that neighboring ones differ in all their bits.
const HASH_GOLDEN = 0x9e3779b9u;

fn hash(seed: u32) -> u32 {
    var x = seed;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

// A hash as a number in [0, 1) with 24 bits, exact.
fn hash_unit(seed: u32) -> f32 {
    return f32(hash(seed) >> 8u) / 16777216.0;
}
