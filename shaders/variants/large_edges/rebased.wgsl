// Large edges, rebased: an exact edge function of 49 bits becomes, per block, an i32 that keeps the sign at every pixel. All
// pixels of a block share their subpixel phase, so E = unit w + r, and the sign of w is the sign of E.
//@ use lib/fixed

const BLOCK_SATURATED = 1073741824; // 2^30

struct BlockEdge {
    q: i32,     // floor(E / unit) at the block's first pixel, saturated to +-2^30
    r: u32,     // E mod unit
    e: f32,     // E
}

// Saturation never changes the sign at any pixel of the block.
fn block_edge(begin: vec2i, end: vec2i, p: vec2i, bias: i32) -> BlockEdge {
    let e = fixed_edge(begin, end, p);
    let biased = fixed_sub(e, Wide(0u, u32(bias)));
    let high = bitcast<i32>(biased.hi) >> SUBPIXEL_BITS;
    let low = bitcast<i32>((biased.lo >> SUBPIXEL_BITS) | (biased.hi << (32u - SUBPIXEL_BITS)));
    let fits = (high == 0 && low >= 0 && low <= BLOCK_SATURATED) || (high == -1 && low < 0 && low >= -BLOCK_SATURATED);
    let saturated = select(BLOCK_SATURATED, -BLOCK_SATURATED, bitcast<i32>(biased.hi) < 0);
    return BlockEdge(select(saturated, low, fits), biased.lo & u32(grid_unit() - 1), fixed_to_f32(e));
}

fn block_contains(e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i) -> bool {
    return ((e0.q + step.x) | (e1.q + step.y) | (e2.q + step.z)) >= 0;
}

// Within two roundings.
fn block_weight(edge: BlockEdge, step: i32, bias: i32) -> f32 {
    let unit = f32(grid_unit());
    let exact = unit * f32(edge.q + step) + f32(edge.r + u32(bias));
    return select(exact, edge.e + unit * f32(step), edge.q == BLOCK_SATURATED);
}
