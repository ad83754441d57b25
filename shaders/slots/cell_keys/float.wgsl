// Cell keys, float: in a tile, a large triangle's edge functions as floats weigh its corners.
//@ use slot/keys
//@ use slot/blocks

struct CellKeys { keys: Keys }

// For a triangle whose corners run clockwise, and the sample of a tile's first pixel.
fn cell_keys_begin(keys: Keys, a: vec2i, b: vec2i, c: vec2i, p: vec2i) -> CellKeys {
    return CellKeys(keys);
}

// At a covered sample, `step` from the tile's first pixel.
fn cell_keys_of(cell: CellKeys, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i, bias: vec3i) -> u32 {
    let weights = vec3f(blocks_weight(e0, step.x, bias.x), blocks_weight(e1, step.y, bias.y), blocks_weight(e2, step.z, bias.z));
    return keys_weighted(cell.keys, weights);
}
