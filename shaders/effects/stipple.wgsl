// Stipple: screen-door transparency by an ordered matrix.
//@ use lib/sample
//@ use lib/hash

struct Stipple {
    /// Fraction of the samples that are drawn.
    @range(0, 1, 0.5) opacity: f32,
    /// Matrix whose order the samples follow: the larger, the more levels.
    @choice(2x2, 4x4, 8x8) @default(8x8) matrix: u32,
    /// Side of one cell of the matrix.
    @range(1, 8, 1) @hard(1, 1024) @unit(px) cell_px: u32,
    /// Shifts the matrix from triangle to triangle, so that layers do not hide behind each other.
    @toggle(0) shift_per_triangle: u32,
    /// Seed of the shifts.
    @range(0, 999, 1) @hard(0, 4294967295) seed: u32,
}

fn stipple(s: Sample, p: Stipple) -> bool {
    let bits = p.matrix + 1u;
    var at = s.at / p.cell_px;
    if p.shift_per_triangle != 0u {
        let shift = hash(s.triangle ^ p.seed);
        at += vec2u(shift & 7u, (shift >> 3u) & 7u);
    }
    // Bayer (1973): bits of x xor y and of y interleaved, lowest first.
    var rank = 0u;
    for (var i = 0u; i < bits; i += 1u) {
        let x = ((at.x ^ at.y) >> i) & 1u;
        let y = (at.y >> i) & 1u;
        rank = (rank << 2u) | (x << 1u) | y;
    }
    return rank < u32(round(p.opacity * f32(1u << (2u * bits))));
}
