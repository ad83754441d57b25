// Large depth: depth keys of large triangles at the samples of a block of 16x16 pixels.
// Chosen with the accuracy axis `depth`: integer for that option, float for all others. Default: float.
//
// raster_large has sixteen blocks in a workgroup, and three edges to a block: before a barrier it calls, for each of the 48
// edges, with p the sample of the block's first pixel:
//@ declare fn large_depth_prepare(index: u32, begin: vec2i, end: vec2i, p: vec2i)
// What is prepared for the block whose edges begin at an index:
//@ declare struct BlockDepth
//@ declare fn block_depth_prepared(plane: DepthPlane, index: u32) -> BlockDepth
// The farthest and the nearest key that any sample of a block of 8x8 pixels may have, `start` being `step` at its first pixel.
//@ declare fn block_depth_range(depth: BlockDepth, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, start: vec3i, dx: vec3i, dy: vec3i) -> vec2u
// Key at a covered sample, `step` as in large_edges.
//@ declare fn block_depth_key(depth: BlockDepth, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i, bias: vec3i) -> u32

//@ variant float
// Edge functions as floats weight the corners.
//@ use lib/fixed
//@ use variants/depth
//@ use variants/large_edges

struct BlockDepth { plane: DepthPlane }

fn large_depth_prepare(index: u32, begin: vec2i, end: vec2i, p: vec2i) {
}

fn block_depth_prepared(plane: DepthPlane, index: u32) -> BlockDepth {
    return BlockDepth(plane);
}

fn block_depth_key(depth: BlockDepth, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i, bias: vec3i) -> u32 {
    let weights = vec3f(block_weight(e0, step.x, bias.x), block_weight(e1, step.y, bias.y), block_weight(e2, step.z, bias.z));
    return depth_weighted(depth.plane, weights);
}

// Depths are a plane over the picture. Roundings, here and at the samples, are within 2^-18 of the sum of all terms' magnitudes, as
// long as nothing is subnormal; farther away the corners alone bound them.
fn block_depth_range(depth: BlockDepth, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, start: vec3i, dx: vec3i, dy: vec3i) -> vec2u {
    if depth.plane.range.x < 1e-15 { return depth_range(depth.plane); }
    let unit = f32(grid_unit());
    let first = vec3f(e0.e, e1.e, e2.e);
    let across = unit * vec3f(-dy);
    let down = unit * vec3f(dx);
    let z = dot(first + unit * vec3f(start), depth.plane.depth);
    let slope = 7.0 * vec2f(dot(across, depth.plane.depth), dot(down, depth.plane.depth));
    let magnitude = dot(abs(first) + unit * vec3f(abs(start)) + 7.0 * (abs(across) + abs(down)), depth.plane.depth);
    let error = magnitude * 3.814697265625e-6;
    let low = z + min(slope.x, 0.0) + min(slope.y, 0.0) - error;
    let high = z + max(slope.x, 0.0) + max(slope.y, 0.0) + error;
    let range = depth.plane.range;
    return vec2u(depth_key(clamp(low, range.x, range.y)), depth_key(clamp(high, range.x, range.y)));
}

//@ variant integer
// Edge functions, exact at the first pixel of a block, are stepped in 64 bits.
//@ use lib/fixed
//@ use variants/depth
//@ use variants/large_edges

// Three edges of sixteen blocks.
var<workgroup> large_depth_exact: array<Wide, 48>;

struct BlockDepth {
    plane: DepthPlane,
    e0: Wide,
    e1: Wide,
    e2: Wide,
}

fn large_depth_prepare(index: u32, begin: vec2i, end: vec2i, p: vec2i) {
    large_depth_exact[index] = fixed_edge(begin, end, p);
}

fn block_depth_prepared(plane: DepthPlane, index: u32) -> BlockDepth {
    return BlockDepth(plane, large_depth_exact[index], large_depth_exact[index + 1u], large_depth_exact[index + 2u]);
}

fn block_depth_stepped(depth: BlockDepth, e: Wide, step: i32) -> u32 {
    let change = Wide(bitcast<u32>(step >> (32u - SUBPIXEL_BITS)), bitcast<u32>(step) << SUBPIXEL_BITS);
    return fixed_down(fixed_add(e, change), depth.plane.shift);
}

fn block_depth_key(depth: BlockDepth, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i, bias: vec3i) -> u32 {
    let edges = vec3u(
        block_depth_stepped(depth, depth.e0, step.x), block_depth_stepped(depth, depth.e1, step.y),
        block_depth_stepped(depth, depth.e2, step.z));
    return depth_packed(depth.plane, depth_quotient(depth.plane, edges));
}

fn block_depth_range(depth: BlockDepth, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, start: vec3i, dx: vec3i, dy: vec3i) -> vec2u {
    return depth_range(depth.plane);
}
