// Psx: corners snap to a coarse grid of the picture, as on a console without fractions of a pixel.
//@ use lib/vertex

struct Psx {
    cell_px: u32,
}

fn psx(vertex: Vertex, p: Psx) -> Vertex {
    var v = vertex;
    v.cell_px = p.cell_px;
    return v;
}
