// Cells, small: no triangle of the scene is large, or an effect draws boxes.
//@ use common/cells
//@ use common/fixed
//@ use slot/coverage

const CELLS_BATCH = 64u;

struct Cell { coverage: Coverage }

fn cells_reach(t: Triangle, first: vec2i) -> u32 {
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    return cells_box(triangle_pixels(min(min(a, b), c), max(max(a, b), c)), first);
}

fn cells_begin(t: Triangle, first: vec2i) -> Cell {
    let area = fixed_small_area(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c));
    let is_turned = area < 0;
    return Cell(coverage_begin(t.a, select(t.b, t.c, is_turned), select(t.c, t.b, is_turned), abs(area), first));
}

// Key at a pixel, `offset` from the tile's first; 0 where the triangle does not cover it.
fn cells_key(cell: Cell, at: vec2i, offset: vec2i) -> u32 {
    let edges = coverage_at(cell.coverage, offset);
    if !coverage_contains(cell.coverage, edges) { return 0u; }
    return coverage_key(cell.coverage, edges);
}
