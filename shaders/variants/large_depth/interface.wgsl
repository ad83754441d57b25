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
