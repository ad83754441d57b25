// Cell keys, integer: in a tile, a large triangle's edge functions, exact at its first pixel, are stepped in 64 bits.
//@ use common/fixed
//@ use common/grid
//@ use slot/keys
//@ use slot/blocks

struct CellKeys {
    keys: Keys,
    e0: Wide,
    e1: Wide,
    e2: Wide,
}

// For a triangle whose corners run clockwise, and the sample of a tile's first pixel.
fn cell_keys_begin(keys: Keys, a: vec2i, b: vec2i, c: vec2i, p: vec2i) -> CellKeys {
    return CellKeys(keys, fixed_edge(b, c, p), fixed_edge(c, a, p), fixed_edge(a, b, p));
}

fn cell_keys_stepped(cell: CellKeys, e: Wide, step: i32) -> u32 {
    let way = Wide(bitcast<u32>(step >> (32u - SUBPIXEL_BITS)), bitcast<u32>(step) << SUBPIXEL_BITS);
    return fixed_down(fixed_add(e, way), cell.keys.shift);
}

// At a covered sample, `step` from the tile's first pixel.
fn cell_keys_of(cell: CellKeys, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i, bias: vec3i) -> u32 {
    let edges = vec3u(
        cell_keys_stepped(cell, cell.e0, step.x), cell_keys_stepped(cell, cell.e1, step.y), cell_keys_stepped(cell, cell.e2, step.z));
    return keys_packed(cell.keys, keys_quotient(cell.keys, edges));
}
