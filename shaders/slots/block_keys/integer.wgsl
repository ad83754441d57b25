// Block keys, integer: a large triangle's edge functions, exact at the first pixel of every block, are stepped in 64 bits.
//@ use common/fixed
//@ use common/grid
//@ use slot/keys
//@ use slot/blocks

// Three edges of sixteen blocks.
var<workgroup> block_keys_exact: array<Wide, 48>;

// Before a barrier, for each edge of each block.
fn block_keys_edge(place: u32, begin: vec2i, end: vec2i, p: vec2i) {
    block_keys_exact[place] = fixed_edge(begin, end, p);
}

fn block_keys_stepped(keys: Keys, place: u32, step: i32) -> u32 {
    let way = Wide(bitcast<u32>(step >> (32u - SUBPIXEL_BITS)), bitcast<u32>(step) << SUBPIXEL_BITS);
    return fixed_down(fixed_add(block_keys_exact[place], way), keys.shift);
}

// At a covered sample, `step` from the first pixel of a block whose edges begin at `place`.
fn block_keys_of(keys: Keys, place: u32, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i, bias: vec3i) -> u32 {
    let edges = vec3u(
        block_keys_stepped(keys, place, step.x), block_keys_stepped(keys, place + 1u, step.y), block_keys_stepped(keys, place + 2u, step.z));
    return keys_packed(keys, keys_quotient(keys, edges));
}
