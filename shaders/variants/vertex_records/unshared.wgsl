// Vertex records, unshared: three records per triangle, one for each corner.
//@ use lib/triangle
//@ use glue/draws

fn vertex_source(id: u32) -> VertexSource {
    let triangle = id / 3u;
    let draw = draw_of_triangle(triangle);
    let at = triangle_vertices(draw, triangle - draws[draw].first_triangle);
    return VertexSource(draw, at[id % 3u], triangle);
}
