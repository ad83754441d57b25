// Positions, packed10: one word a vertex, ten bits an axis from x in the lowest, steps in the box of its primitive. The two
// bits above say that the file's position was refused, as `common/vertex` has it.
//@ use common/draws
//@ use slot/bytes

fn positions_bits(draw: u32, vertex: u32) -> vec3u {
    let word = vertex_bytes[draws[draw].position_offset / 4u + vertex];
    let steps = vec3f((vec3u(word) >> vec3u(0u, 10u, 20u)) & vec3u(1023u));
    let place = draws[draw].origin.xyz + draws[draw].step.xyz * steps;
    // NaN, or 2^127.
    let refused = select(0x7f000000u, 0x7fc00000u, (word & 0x40000000u) != 0u);
    return select(bitcast<vec3u>(place), vec3u(refused), vec3<bool>((word >> 30u) != 0u));
}
