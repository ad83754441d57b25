// Blocks, float: edge functions in f32, once per block of 16x16 pixels, stepped to each of them. Rounding decides near edges.
//@ use common/fixed
//@ use common/grid

// Samples on an edge belong to the triangle only where the edge is a top or left one; else all do.
override IS_TOP_LEFT: bool = true;

struct BlockEdge {
    e: f32,     // E at the block's first pixel
    least: f32, // what a sample must reach to be inside
}

fn blocks_edge(begin: vec2i, end: vec2i, p: vec2i, bias: i32) -> BlockEdge {
    let d = vec2f(end) - vec2f(begin);
    let away = vec2f(p) - vec2f(begin);
    return BlockEdge(d.x * away.y - d.y * away.x, select(0.0, 1e-30, IS_TOP_LEFT && bias == 1));
}

// Are all three edges on their inner side, `step` from the block's first pixel?
fn blocks_contain(e0: BlockEdge, e1: BlockEdge, e2: BlockEdge, step: vec3i) -> bool {
    let e = vec3f(e0.e, e1.e, e2.e) + vec3f(step) * f32(grid_unit());
    return all(e >= vec3f(e0.least, e1.least, e2.least));
}

fn blocks_weight(edge: BlockEdge, step: i32, bias: i32) -> f32 {
    return edge.e + f32(grid_unit()) * f32(step);
}
