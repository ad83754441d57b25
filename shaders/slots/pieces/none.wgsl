// ClippedTriangles, none: nothing was clipped, so every queue entry is a triangle.
//@ use common/triangle

fn pieces_load(entry: u32) -> Triangle {
    return triangle_load(entry);
}
