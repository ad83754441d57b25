// Blocks, rebased: edge functions of 49 bits, once per block of 16x16 pixels, become an i32 that keeps every sign: all pixels
// of a block share their sub-pixel phase, so E = unit w + r, and the sign of w is the sign of E.
//@ use common/fixed
//@ use common/grid

const BLOCKS_SATURATED = 1073741824; // 2^30

struct BlockEdge {
    q: i32,     // floor(E / unit) at the block's first pixel, saturated to +-2^30
    r: u32,     // E mod unit
    e: f32,     // E
}

// E / unit without its remainder, where it may be saturated without changing the sign of any pixel of the block.
fn blocks_edge(begin: vec2i, end: vec2i, p: vec2i, bias: i32) -> BlockEdge {
    let e = fixed_edge(begin, end, p);
    let biased = fixed_sub(e, Wide(0u, u32(bias)));
    let high = bitcast<i32>(biased.hi) >> SUBPIXEL_BITS;
    let low = bitcast<i32>((biased.lo >> SUBPIXEL_BITS) | (biased.hi << (32u - SUBPIXEL_BITS)));
    let fits = (high == 0 && low >= 0 && low <= BLOCKS_SATURATED) || (high == -1 && low < 0 && low >= -BLOCKS_SATURATED);
    let saturated = select(BLOCKS_SATURATED, -BLOCKS_SATURATED, bitcast<i32>(biased.hi) < 0);
    return BlockEdge(select(saturated, low, fits), biased.lo & u32(grid_unit() - 1), fixed_to_f32(e));
}

// Are all three edges on their inner side, `step` from the block's first pixel?
fn blocks_contain(e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i) -> bool {
    return ((e0.q + step.x) | (e1.q + step.y) | (e2.q + step.z)) >= 0;
}

// Weight of an edge at a covered sample, `step` from its block's first pixel: E as a float, within two roundings.
fn blocks_weight(edge: BlockEdge, step: i32, bias: i32) -> f32 {
    let unit = f32(grid_unit());
    let exact = unit * f32(edge.q + step) + f32(edge.r + u32(bias));
    return select(exact, edge.e + unit * f32(step), edge.q == BLOCKS_SATURATED);
}
