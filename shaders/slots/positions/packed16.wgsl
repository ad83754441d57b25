// Positions, packed16: two words a vertex, sixteen bits an axis, steps in the box of its primitive. The upper half of the
// second word says that the file's position was refused, as `common/vertex` has it.
//@ use common/draws
//@ use slot/bytes

fn positions_bits(draw: u32, vertex: u32) -> vec3u {
    let at = draws[draw].position_offset / 4u + 2u * vertex;
    let words = vec2u(vertex_bytes[at], vertex_bytes[at + 1u]);
    let steps = vec3f(vec3u(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu));
    let place = draws[draw].origin.xyz + draws[draw].step.xyz * steps;
    // NaN, or 2^127.
    let refused = select(0x7f000000u, 0x7fc00000u, (words.y & 0x10000u) != 0u);
    return select(bitcast<vec3u>(place), vec3u(refused), vec3<bool>((words.y >> 16u) != 0u));
}
