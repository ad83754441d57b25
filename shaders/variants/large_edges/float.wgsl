// Large edges, float: edge functions in f32, stepped to each pixel of the block. Rounding decides near edges.
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
