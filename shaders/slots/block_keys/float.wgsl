// Block keys, float: a large triangle's edge functions as floats weigh its corners.
//@ use slot/keys
//@ use slot/blocks

// Before a barrier, for each edge of each block.
fn block_keys_edge(place: u32, begin: vec2i, end: vec2i, p: vec2i) {
}

// At a covered sample, `step` from the first pixel of a block whose edges begin at `place`.
fn block_keys_of(keys: Keys, place: u32, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i, bias: vec3i) -> u32 {
    let weights = vec3f(blocks_weight(e0, step.x, bias.x), blocks_weight(e1, step.y, bias.y), blocks_weight(e2, step.z, bias.z));
    return keys_weighted(keys, weights);
}
