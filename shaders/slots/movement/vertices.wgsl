// Movement, vertices: effects move a vertex, whatever triangles meet there.
//@ use common/movement

// A corner as the effects leave it; `p` is the vertex in object space.
fn movement_corner(draw: u32, vertex: u32, id: u32, p: vec3f) -> Vertex {
    return glue_vertex(movement_vertex(draw, vertex, p));
}
