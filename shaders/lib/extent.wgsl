// Extent: bounds in clip space of a box of object space. They are wide enough for every rounding here, in the projection and in
// the clipper, so culling never removes anything visible.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/geometry
//@ use variants/draw_records

struct Box {
    center: vec3f,
    half: vec3f,
}

struct Extent {
    low: vec4f,   // bounds of x, y, z, w over the box
    high: vec4f,
    sides: vec4f, // largest w + x, w - x, w + y, w - y: negative where the box lies outside that side of the view volume
    near: f32,    // largest w - z
    sums: vec4f,  // largest sum of the absolute terms of x, y, z, w
}

// Bound on the rounding of sums of four products, of cuts at five planes and of these bounds, relative to the terms.
const EXTENT_ERROR = 7.62939453125e-6; // 2^-17

// An object-space position as the draw's matrix expects it.
fn extent_position(draw: u32, position: vec3f) -> vec3f {
    return select(position, position - draw_origin(draw), vec3<bool>(IS_RELATIVE));
}

fn extent_of(draw: u32, box: Box) -> Extent {
    let m = draws[draw].clip_from_object;
    let c = extent_position(draw, box.center);
    let h = box.half;
    let far = abs(c) + h;
    let middle = m[0] * c.x + m[1] * c.y + m[2] * c.z + m[3];
    let radius = abs(m[0]) * h.x + abs(m[1]) * h.y + abs(m[2]) * h.z;
    let sums = abs(m[0]) * far.x + abs(m[1]) * far.y + abs(m[2]) * far.z + abs(m[3]);
    let error = EXTENT_ERROR * sums;
    let s0 = extent_sides(m[0]);
    let s1 = extent_sides(m[1]);
    let s2 = extent_sides(m[2]);
    let sides = s0 * c.x + s1 * c.y + s2 * c.z + extent_sides(m[3]) + abs(s0) * h.x + abs(s1) * h.y + abs(s2) * h.z;
    let n = vec4f(m[0].w - m[0].z, m[1].w - m[1].z, m[2].w - m[2].z, m[3].w - m[3].z);
    let near = n.x * c.x + n.y * c.y + n.z * c.z + n.w + abs(n.x) * h.x + abs(n.y) * h.y + abs(n.z) * h.z;
    return Extent(
        middle - radius - error, middle + radius + error, sides + error.w + error.xxyy, near + error.w + error.z, sums);
}

fn extent_sides(column: vec4f) -> vec4f {
    return vec4f(column.w + column.x, column.w - column.x, column.w + column.y, column.w - column.y);
}

// Does the box lie outside a side of the view volume, or between the eye and the near plane?
fn extent_is_outside(e: Extent) -> bool {
    return any(e.sides < vec4f(0.0)) || e.near < 0.0;
}

// Does the box lie behind the near plane, and not far outside the sides of the view volume?
fn extent_is_unclipped(e: Extent) -> bool {
    let reach = max(max(abs(e.low.x), abs(e.high.x)), max(abs(e.low.y), abs(e.high.y)));
    return e.low.w > 0.0 && e.low.w > e.high.z && reach < 2.0 * e.low.w;
}

// Largest distance in units, snap included, between a projected corner and its exact position, for corners inside an unclipped
// extent: twice the error that the oracle allows the projection.
fn extent_shift(e: Extent) -> f32 {
    let size = max(frame.center.x, frame.center.y);
    return 1.0 + size * 4.76837158203125e-7 * (4.0 * max(e.sums.x, e.sums.y) + 8.0 * e.sums.w + 10.0 * e.low.w) / e.low.w;
}
