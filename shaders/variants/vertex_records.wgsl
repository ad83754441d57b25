// Vertex records: which vertex a snapped vertex is the projection of.
// Chosen by the stack: unshared where vertex effects move corners triangle by triangle.
//
// The vertex of a record.
//@ declare fn vertex_source(id: u32) -> VertexSource

//@ variant default
// One record per vertex of every draw, shared by all triangles that join it.
//@ use lib/triangle
//@ use glue/draws

fn vertex_source(id: u32) -> VertexSource {
    let draw = draw_of_vertex(id);
    return VertexSource(draw, id - draws[draw].first_vertex, 0u);
}

//@ variant unshared
// Three records per triangle, one for each corner.
//@ use lib/triangle
//@ use glue/draws

fn vertex_source(id: u32) -> VertexSource {
    let triangle = id / 3u;
    let draw = draw_of_triangle(triangle);
    let at = triangle_vertices(draw, triangle - draws[draw].first_triangle);
    return VertexSource(draw, at[id % 3u], triangle);
}
