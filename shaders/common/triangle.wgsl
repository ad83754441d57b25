// Triangles as the rasterizer meets them: three projected corners, by id or as a piece left over from clipping.
//@ use common/frame
//@ use common/grid
//@ use common/draws
//@ use common/vertex
//@ use common/topology
//@ use slot/corners
//@ use slot/records

struct Triangle {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    id: u32,
    draw: u32,
    entry: u32,    // its place among all triangles and, behind them, pieces
    outline: u32,  // bit k: the edge opposite corner k is no cut
}

fn triangle_load(id: u32) -> Triangle {
    return triangle_of(draws_of_triangle(id), id);
}

// The same where its draw is known.
fn triangle_of(draw: u32, id: u32) -> Triangle {
    let at = corners_of(draw, id);
    return Triangle(vertices[at.x], vertices[at.y], vertices[at.z], id, draw, id, 7u);
}

// Is a triangle of this orientation drawn at all, by the flags of its draw? Clockwise on screen (area > 0) is the back of a glTF triangle.
fn triangle_is_shown(flags: u32, is_clockwise: bool) -> bool {
    let is_back = is_clockwise != ((flags & DRAW_MIRRORED) != 0u);
    return (flags & DRAW_DOUBLE_SIDED) != 0u || !is_back;
}

// First and last candidate pixel of a box in units, clamped to the picture; empty where a last precedes a first.
fn triangle_pixels(low: vec2i, high: vec2i) -> vec4i {
    let first = max(grid_first(low), vec2i(0));
    let last = min(grid_last(high), vec2i(frame.size) - 1);
    return vec4i(first, last);
}
