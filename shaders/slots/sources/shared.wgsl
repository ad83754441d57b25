// Sources, shared: a projected record is a vertex of a draw.
//@ use common/draws

struct Source { draw: u32, vertex: u32, triangle: u32 }

// What record `id` is the projection of; nobody asks for its triangle.
fn sources_of(id: u32) -> Source {
    let draw = draws_of_vertex(id);
    return Source(draw, id - draws[draw].first_vertex, 0u);
}
