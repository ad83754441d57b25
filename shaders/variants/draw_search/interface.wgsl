// Draw search: the draw that a triangle or a vertex belongs to.
// Chosen by the number of draws. Default: the functions below, for a scene of one draw. A loop that an override switches off
// would still cost 6 % of a frame of ten million triangles (NVIDIA H200), so the search is text that such a kernel does not have.

//@ declare fn draw_of_triangle(id: u32) -> u32
fn draw_of_triangle(id: u32) -> u32 {
    return 0u;
}

//@ declare fn draw_of_vertex(id: u32) -> u32
fn draw_of_vertex(id: u32) -> u32 {
    return 0u;
}
