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
