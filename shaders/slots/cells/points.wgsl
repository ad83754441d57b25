// Cells, points: the corners of triangles as discs.
//@ use common/cells
//@ use common/points
//@ use slot/depth

const CELLS_BATCH = 64u;

struct Cell {
    a: vec4u,
    b: vec4u,
    c: vec4u,
}

// Discs of one triangle may lie far apart.
fn cells_reach(t: Triangle, first: vec2i) -> u32 {
    return cells_box(vec4i(first, first + 15), first);
}

fn cells_begin(t: Triangle, first: vec2i) -> Cell {
    return Cell(t.a, t.b, t.c);
}

// Key at a pixel, that of the nearest corner there; 0 where no disc covers it.
fn cells_key(cell: Cell, at: vec2i, offset: vec2i) -> u32 {
    let corner = points_corner(cell.a, cell.b, cell.c, grid_sample(at));
    let z = select(select(cell.c.z, cell.b.z, corner == 1u), cell.a.z, corner == 0u);
    return select(depth_key(bitcast<f32>(z)), 0u, corner == 3u);
}
