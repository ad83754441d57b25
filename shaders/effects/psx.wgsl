// Psx: corners snap to a coarse grid of the picture, and tremble as they move. A console without fractions of a pixel drew so.
//@ use lib/vertex

struct Psx {
    /// Side of a cell.
    @range(1, 16, 4) @hard(1, 256) @unit(px) cell_px: u32,
}

fn psx(vertex: Vertex, p: Psx) -> Vertex {
    var v = vertex;
    v.cell_px = p.cell_px;
    return v;
}
