// Shape: what is filled for a triangle. Its samples; its bounding box; or discs about its corners, `frame.point_radius` units
// in radius, where a sample under several discs belongs to the nearest corner, and of equally near ones to the first.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle

override SHAPE: u32 = 0u;

const SHAPE_TRIANGLES = 0u;
const SHAPE_BOXES = 1u;
const SHAPE_POINTS = 2u;

// Is the sample at p in the disc of a corner?
fn disc_contains(corner: vec4u, p: vec2i) -> bool {
    let d = p - vertex_at(corner);
    let r = i32(frame.point_radius);
    // The squares would wrap outside the box of the disc.
    return max(abs(d.x), abs(d.y)) <= r && d.x * d.x + d.y * d.y <= r * r;
}

// The corner that a sample belongs to: 0, 1 or 2, or 3 for none.
fn disc_corner(a: vec4u, b: vec4u, c: vec4u, p: vec2i) -> u32 {
    var corner = 3u;
    var depth = 0u;
    if disc_contains(a, p) { corner = 0u; depth = a.z; }
    if disc_contains(b, p) && (corner == 3u || b.z > depth) { corner = 1u; depth = b.z; }
    if disc_contains(c, p) && (corner == 3u || c.z > depth) { corner = 2u; }
    return corner;
}

// First and last candidate pixel of a disc; empty where the last precedes the first.
fn disc_pixels(corner: vec4u) -> vec4i {
    let at = vertex_at(corner);
    let r = i32(frame.point_radius);
    return vec4i(max(grid_first(at - r), vec2i(0)), min(grid_last(at + r + 1), vec2i(frame.size) - 1));
}

// The most rows of a disc.
fn disc_rows() -> u32 {
    return 2u * u32(frame.point_radius) / u32(grid_unit()) + 2u;
}

// Invocations that divide the rows of a triangle's discs among them.
override INVOCATIONS_PER_TRIANGLE: u32 = 1u;
