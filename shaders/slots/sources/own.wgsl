// Sources, own: a projected record is one corner of one triangle.
//@ use common/topology

struct Source { draw: u32, vertex: u32, triangle: u32 }

// What record `id` is the projection of.
fn sources_of(id: u32) -> Source {
    let triangle = id / 3u;
    let draw = draws_of_triangle(triangle);
    let at = triangle_vertices(draw, triangle - draws[draw].first_triangle);
    return Source(draw, at[id % 3u], triangle);
}
