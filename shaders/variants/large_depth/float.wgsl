// Large depth, float: edge functions as floats weight the corners.
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
