// Ranks of the matrices of ordered dithering (Bayer 1973).

// Rank of a cell in the order in which a matrix with a side of 2^bits fills up: for every bit, the checkerboard first.
fn bayer_rank(x: u32, y: u32, bits: u32) -> u32 {
    var rank = 0u;
    for (var bit = 0u; bit < bits; bit += 1u) {
        rank = (rank << 2u) | ((((x ^ y) >> bit) & 1u) << 1u) | ((y >> bit) & 1u);
    }
    return rank;
}
