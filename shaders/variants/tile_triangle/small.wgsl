// Tile triangles, small: the scene has no large triangle, or an effect draws boxes.
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/tile_box
//@ use variants/coverage

const TILE_BATCH = 64u;

struct TileTriangle { coverage: Coverage }

fn tile_triangle_box(t: Triangle, first: vec2i) -> u32 {
    return tile_box_of(t, first);
}

fn tile_triangle(t: Triangle, first: vec2i) -> TileTriangle {
    let area = fixed_small_area(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c));
    let is_reversed = area < 0;
    return TileTriangle(coverage_begin(t.a, select(t.b, t.c, is_reversed), select(t.c, t.b, is_reversed), abs(area), first));
}

fn tile_triangle_key(triangle: TileTriangle, at: vec2i, offset: vec2i) -> u32 {
    let edges = coverage_at(triangle.coverage, offset);
    if !coverage_contains(triangle.coverage, edges) { return 0u; }
    return coverage_key(triangle.coverage, edges);
}
