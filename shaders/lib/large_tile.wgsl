// Tile of a large triangle: 64x64 pixels, in sixteen blocks of 16x16 pixels in which edge functions are rebased.
//@ use lib/fixed
//@ use lib/queued_triangle
//@ use variants/large_edges
//@ use variants/large_depth

// Three edges of sixteen blocks.
var<workgroup> tile_edges: array<BlockEdge, 48>;

// What the blocks of a tile need, to be read behind a barrier. `tile`: its first pixel.
fn large_tile_prepare(t: ClockwiseTriangle, tile: vec2i, invocation_index: u32) {
    if invocation_index >= 48u { return; }
    let block = i32(invocation_index / 3u);
    let p = grid_sample(tile + vec2i(block % 4, block / 4) * 16);
    let edge = invocation_index % 3u;
    let begin = select(select(t.a, t.c, edge == 1u), t.b, edge == 0u);
    let end = select(select(t.b, t.a, edge == 1u), t.c, edge == 0u);
    tile_edges[invocation_index] = block_edge(begin, end, p, t.bias[edge]);
    large_depth_prepare(invocation_index, begin, end, p);
}
