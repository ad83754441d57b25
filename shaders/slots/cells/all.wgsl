// Cells, all: triangles of every size, each with the edges of its own size, as the other kernels have them: a tile is one
// block, to which the edges of a large triangle are rebased.
//@ use common/cells
//@ use common/fixed
//@ use common/grid
//@ use slot/coverage
//@ use slot/blocks
//@ use slot/cell_keys

const CELLS_BATCH = 32u;
const CELLS_SMALL_EXTENT = 32768;

struct Cell {
    coverage: Coverage,
    e0: BlockEdge,
    e1: BlockEdge,
    e2: BlockEdge,
    is_large: u32,
    dx: vec3i,
    dy: vec3i,
    bias: vec3i,
    keys: CellKeys,
}

fn cells_reach(t: Triangle, first: vec2i) -> u32 {
    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    return cells_box(triangle_pixels(min(min(a, b), c), max(max(a, b), c)), first);
}

fn cells_begin(t: Triangle, first: vec2i) -> Cell {
    var cell: Cell;
    let a = vertex_at(t.a);
    var b = vertex_at(t.b);
    var c = vertex_at(t.c);
    let sides = max(max(a, b), c) - min(min(a, b), c);
    if max(sides.x, sides.y) <= CELLS_SMALL_EXTENT {
        let area = fixed_small_area(a, b, c);
        let is_turned = area < 0;
        cell.coverage = coverage_begin(t.a, select(t.b, t.c, is_turned), select(t.c, t.b, is_turned), abs(area), first);
        return cell;
    }
    cell.is_large = 1u;
    var z = vec3u(t.a.z, t.b.z, t.c.z);
    var area = fixed_edge(a, b, c);
    if fixed_sign(area) < 0 {
        let swap = b;
        b = c;
        c = swap;
        z = z.xzy;
        area = fixed_edge(a, b, c);
    }
    let dx = vec3i(c.x - b.x, a.x - c.x, b.x - a.x);
    let dy = vec3i(c.y - b.y, a.y - c.y, b.y - a.y);
    let bias = vec3i(fixed_bias(vec2i(dx.x, dy.x)), fixed_bias(vec2i(dx.y, dy.y)), fixed_bias(vec2i(dx.z, dy.z)));
    let p = grid_sample(first);
    cell.e0 = blocks_edge(b, c, p, bias.x);
    cell.e1 = blocks_edge(c, a, p, bias.y);
    cell.e2 = blocks_edge(a, b, p, bias.z);
    cell.dx = dx;
    cell.dy = dy;
    cell.bias = bias;
    cell.keys = cell_keys_begin(keys_begin_wide(z, area), a, b, c, p);
    return cell;
}

// Key at a pixel, `offset` from the tile's first; 0 where the triangle does not cover it.
fn cells_key(cell: Cell, at: vec2i, offset: vec2i) -> u32 {
    if cell.is_large != 0u {
        let step = cell.dx * offset.y - cell.dy * offset.x;
        if !blocks_contain(cell.e0, cell.e1, cell.e2, step) { return 0u; }
        return cell_keys_of(cell.keys, cell.e0, cell.e1, cell.e2, step, cell.bias);
    }
    let edges = coverage_at(cell.coverage, offset);
    if !coverage_contains(cell.coverage, edges) { return 0u; }
    return coverage_key(cell.coverage, edges);
}
