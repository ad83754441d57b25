// Corners, shared: one projected record per vertex of each draw, whatever triangles meet there.
//@ use common/topology

// Records of the three corners of a triangle.
fn corners_of(draw: u32, id: u32) -> vec3u {
    return draws[draw].first_vertex + triangle_vertices(draw, id - draws[draw].first_triangle);
}
