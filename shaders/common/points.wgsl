// Points: discs about the corners of a triangle, `frame.point_radius` units in radius. A sample under several of them is
// drawn once, as the nearest corner's, and of equally near ones the first's.
//@ use common/frame
//@ use common/grid
//@ use common/vertex

// Is the sample at p, which lies in the box of the disc, in the disc?
fn points_contain(corner: vec4u, p: vec2i) -> bool {
    let d = p - vertex_at(corner);
    let r = i32(frame.point_radius);
    // Beyond the box squares would wrap.
    return max(abs(d.x), abs(d.y)) <= r && d.x * d.x + d.y * d.y <= r * r;
}

// Which of three corners a sample belongs to: 0, 1, 2, or 3 for none.
fn points_corner(a: vec4u, b: vec4u, c: vec4u, p: vec2i) -> u32 {
    var corner = 3u;
    var depth = 0u;
    if points_contain(a, p) { corner = 0u; depth = a.z; }
    if points_contain(b, p) && (corner == 3u || b.z > depth) { corner = 1u; depth = b.z; }
    if points_contain(c, p) && (corner == 3u || c.z > depth) { corner = 2u; }
    return corner;
}

// First and last candidate pixel of a disc; empty where a last precedes a first.
fn points_pixels(corner: vec4u) -> vec4i {
    let at = vertex_at(corner);
    let r = i32(frame.point_radius);
    return vec4i(max(grid_first(at - r), vec2i(0)), min(grid_last(at + r + 1), vec2i(frame.size) - 1));
}
