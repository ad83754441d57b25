// Large depth, integer: edge functions, exact at the first pixel of a block, are stepped in 64 bits.
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
