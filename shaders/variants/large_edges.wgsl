// Large edges: edge functions of large triangles, set up once per block of 16x16 pixels.
// Chosen with the accuracy axis `coverage`. Default: rebased; float for both float options.
//
// An edge function of one block.
//@ declare struct BlockEdge
// For the edge begin -> end, p the sample of the block's first pixel, and the bias of the top-left rule.
//@ declare fn block_edge(begin: vec2i, end: vec2i, p: vec2i, bias: i32) -> BlockEdge
// Is the sample inside all three edges? `step` is dx * y - dy * x of each edge, for an offset of (x, y) pixels in the block.
//@ declare fn block_contains(e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i) -> bool
// Weight of the corner opposite an edge at a covered sample, as a float.
//@ declare fn block_weight(edge: BlockEdge, step: i32, bias: i32) -> f32

//@ variant rebased
// An exact edge function of 49 bits becomes, per block, an i32 that keeps the sign at every pixel. All
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

//@ variant float
// Edge functions in f32, stepped to each pixel of the block. Rounding decides near edges.
//@ use lib/fixed

struct BlockEdge {
    e: f32,     // E at the block's first pixel
    least: f32, // least edge function of a covered sample
}

fn block_edge(begin: vec2i, end: vec2i, p: vec2i, bias: i32) -> BlockEdge {
    let d = vec2f(end) - vec2f(begin);
    let away = vec2f(p) - vec2f(begin);
    return BlockEdge(d.x * away.y - d.y * away.x, select(0.0, 1e-30, IS_TOP_LEFT && bias == 1));
}

fn block_contains(e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i) -> bool {
    let e = vec3f(e0.e, e1.e, e2.e) + vec3f(step) * f32(grid_unit());
    return all(e >= vec3f(e0.least, e1.least, e2.least));
}

fn block_weight(edge: BlockEdge, step: i32, bias: i32) -> f32 {
    return edge.e + f32(grid_unit()) * f32(step);
}
