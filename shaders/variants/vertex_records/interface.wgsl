// Vertex records: which vertex a snapped vertex is the projection of.
// Chosen by the stack: unshared where vertex effects move corners triangle by triangle. Default: the function below, one record
// per vertex of every draw, shared by all triangles that join it.
//@ use lib/triangle
//@ use glue/draws

//@ declare fn vertex_source(id: u32) -> VertexSource
fn vertex_source(id: u32) -> VertexSource {
    let draw = draw_of_vertex(id);
    return VertexSource(draw, id - draws[draw].first_vertex, 0u);
}
