// Large depth, float: edge functions as floats weight the corners.
//@ use variants/depth
//@ use variants/large_edges

struct BlockDepth { plane: DepthPlane }

fn large_depth_prepare(index: u32, begin: vec2i, end: vec2i, p: vec2i) {
}

fn block_depth(plane: DepthPlane, a: vec2i, b: vec2i, c: vec2i, p: vec2i) -> BlockDepth {
    return BlockDepth(plane);
}

fn block_depth_prepared(plane: DepthPlane, index: u32) -> BlockDepth {
    return BlockDepth(plane);
}

fn block_depth_key(depth: BlockDepth, e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i, bias: vec3i) -> u32 {
    let weights = vec3f(block_weight(e0, step.x, bias.x), block_weight(e1, step.y, bias.y), block_weight(e2, step.z, bias.z));
    return depth_weighted(depth.plane, weights);
}
