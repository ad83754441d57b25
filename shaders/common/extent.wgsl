// Extent: how far a box of object space reaches in clip space, taken wide enough for whatever rounds on the way, here and in
// the projection and the clipper: culling must never show.
//@ use common/frame
//@ use common/grid
//@ use common/draws
//@ use common/transform

struct Box {
    center: vec3f,
    half: vec3f,
}

struct Extent {
    low: vec4f,   // of x, y, z, w over the box
    high: vec4f,
    sides: vec4f, // most that w + x, w - x, w + y, w - y come to: negative where all is beyond that side of the picture
    near: f32,    // the same of w - z
    sums: vec4f,  // most that the terms of x, y, z, w add up to, each taken as positive
}

// Rounding of sums of four products, of cuts at five planes and of what bounds them, as a share of the terms.
const EXTENT_SLACK = 7.62939453125e-6; // 2^-17

// A place of object space as the draw's matrix expects it.
fn extent_place(draw: u32, place: vec3f) -> vec3f {
    return select(place, place - draws[draw].origin.xyz, vec3<bool>(IS_RELATIVE));
}

fn extent_of(draw: u32, box: Box) -> Extent {
    let m = draws[draw].clip_from_object;
    let c = extent_place(draw, box.center);
    let h = box.half;
    let far = abs(c) + h;
    let middle = m[0] * c.x + m[1] * c.y + m[2] * c.z + m[3];
    let reach = abs(m[0]) * h.x + abs(m[1]) * h.y + abs(m[2]) * h.z;
    let sums = abs(m[0]) * far.x + abs(m[1]) * far.y + abs(m[2]) * far.z + abs(m[3]);
    let slack = EXTENT_SLACK * sums;
    let s0 = extent_sides(m[0]);
    let s1 = extent_sides(m[1]);
    let s2 = extent_sides(m[2]);
    let sides = s0 * c.x + s1 * c.y + s2 * c.z + extent_sides(m[3]) + abs(s0) * h.x + abs(s1) * h.y + abs(s2) * h.z;
    let n = vec4f(m[0].w - m[0].z, m[1].w - m[1].z, m[2].w - m[2].z, m[3].w - m[3].z);
    let near = n.x * c.x + n.y * c.y + n.z * c.z + n.w + abs(n.x) * h.x + abs(n.y) * h.y + abs(n.z) * h.z;
    return Extent(
        middle - reach - slack, middle + reach + slack, sides + slack.w + slack.xxyy, near + slack.w + slack.z, sums);
}

fn extent_sides(column: vec4f) -> vec4f {
    return vec4f(column.w + column.x, column.w - column.x, column.w + column.y, column.w - column.y);
}

// Does the box lie beyond a side of the picture, or before the near plane?
fn extent_is_outside(e: Extent) -> bool {
    return any(e.sides < vec4f(0.0)) || e.near < 0.0;
}

// Does it lie behind the near plane, and not far beyond the sides of the picture?
fn extent_is_plain(e: Extent) -> bool {
    let reach = max(max(abs(e.low.x), abs(e.high.x)), max(abs(e.low.y), abs(e.high.y)));
    return e.low.w > 0.0 && e.low.w > e.high.z && reach < 2.0 * e.low.w;
}

// Units by which a corner inside a plain extent may lie off its place on screen, the snap included: twice the bound to which
// the judge holds the projection.
fn extent_shift(e: Extent) -> f32 {
    let size = max(frame.center.x, frame.center.y);
    return 1.0 + size * 4.76837158203125e-7 * (4.0 * max(e.sums.x, e.sums.y) + 8.0 * e.sums.w + 10.0 * e.low.w) / e.low.w;
}
