// Stipple: screen-door transparency by an ordered integer matrix.
//@ use lib/sample
//@ use lib/hash

struct Stipple {
    opacity: f32,
    matrix: u32,
    cell_px: u32,
    shift_per_triangle: u32,
    seed: u32,
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
