// Tile triangles, all: triangles of every size, with the edge functions of their size class. A tile is one block, for which
// the edges of a large triangle are set up.
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/tile_box
//@ use lib/queued_triangle
//@ use variants/coverage
//@ use variants/depth
//@ use variants/large_edges
//@ use variants/large_depth

const TILE_BATCH = 32u;

struct TileTriangle {
    coverage: Coverage,
    e0: BlockEdge,
    e1: BlockEdge,
    e2: BlockEdge,
    is_large: u32,
    dx: vec3i,
    dy: vec3i,
    bias: vec3i,
    depth: BlockDepth,
}

fn tile_triangle_box(t: Triangle, first: vec2i) -> u32 {
    return tile_box_of(t, first);
}

fn tile_triangle(t: Triangle, first: vec2i) -> TileTriangle {
    var triangle: TileTriangle;
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let extent = max(max(a, b), c) - min(min(a, b), c);
    if max(extent.x, extent.y) <= SMALL_EXTENT {
        let area = fixed_small_area(a, b, c);
        let is_reversed = area < 0;
        triangle.coverage = coverage_begin(t.a, select(t.b, t.c, is_reversed), select(t.c, t.b, is_reversed), abs(area), first);
        return triangle;
    }
    triangle.is_large = 1u;
    let large = clockwise_triangle(t);
    let p = grid_sample(first);
    triangle.e0 = block_edge(large.b, large.c, p, large.bias.x);
    triangle.e1 = block_edge(large.c, large.a, p, large.bias.y);
    triangle.e2 = block_edge(large.a, large.b, p, large.bias.z);
    triangle.dx = large.dx;
    triangle.dy = large.dy;
    triangle.bias = large.bias;
    triangle.depth = block_depth(depth_plane_wide(large.z, large.area), large.a, large.b, large.c, p);
    return triangle;
}

fn tile_triangle_key(triangle: TileTriangle, at: vec2i, offset: vec2i) -> u32 {
    if triangle.is_large != 0u {
        let step = triangle.dx * offset.y - triangle.dy * offset.x;
        if !block_contains(triangle.e0, triangle.e1, triangle.e2, step) { return 0u; }
        return block_depth_key(triangle.depth, triangle.e0, triangle.e1, triangle.e2, step, triangle.bias);
    }
    let edges = coverage_at(triangle.coverage, offset);
    if !coverage_contains(triangle.coverage, edges) { return 0u; }
    return coverage_key(triangle.coverage, edges);
}
