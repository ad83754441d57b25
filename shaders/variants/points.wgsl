// Points: what triangles are where some primitives are points or lines. A point is a triangle whose corners are one. It is drawn as a triangle
// about that, whose corners all have its depth. Of that its disc is shown, or where the disc is smaller than the least one, which holds a
// sample wherever it lies, the pixel in which the point lies. A segment of a line is two triangles between the points half a pixel beside its
// ends, across the axis along which it is longer: so it has one sample in each column or each row. Integers decide.
// Chosen by the scene, and by the effect that draws corners as discs.
//
// The triangle that is drawn.
//@ declare fn triangle_spread(t: Triangle) -> Triangle
// The sign of its area on the screen; a point shows its front.
//@ declare fn triangle_orientation(t: Triangle) -> i32
// The box of what is shown of a small one, in units, given that of its corners.
//@ declare fn triangle_box(t: Triangle, corners: vec4i) -> vec4i
// Is it a point whose normal shows away from the viewer, given the cosine? Scanners do not tell the sides apart.
//@ declare fn point_is_turned(draw: u32, toward: f32) -> bool
// Is it no point, or does it show at the sample of a pixel?
//@ may declare fn point_covers(t: Triangle, pixel: vec2i) -> bool
//
// Where all primitives are points they are drawn from their records: the disc of one, does it show at the sample of a pixel, and the triangle
// about it, given a triangle whose corners are all the record.
//@ may declare struct Point
//@ may declare fn point_from(draw: u32, record: vec4u) -> Point
//@ may declare fn point_shows(point: Point, pixel: vec2i) -> bool
//@ may declare fn point_triangle(point: Point, t: Triangle) -> Triangle

//@ variant default
// No primitive is points.
//@ use lib/fixed
//@ use lib/triangle

fn triangle_spread(t: Triangle) -> Triangle {
    return t;
}

fn triangle_orientation(t: Triangle) -> i32 {
    return fixed_sign(fixed_edge(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c)));
}

fn triangle_box(t: Triangle, corners: vec4i) -> vec4i {
    return corners;
}

fn point_is_turned(draw: u32, toward: f32) -> bool {
    return false;
}

//@ variant corners
// The corners of triangles are drawn, and those of points and lines.
//@ use lib/fixed
//@ use lib/triangle
//@ use glue/draws
//@ use variants/draw_records

fn triangle_spread(t: Triangle) -> Triangle {
    return t;
}

fn triangle_orientation(t: Triangle) -> i32 {
    if draw_topology(t.draw) >= TOPOLOGY_POINTS { return select(-1, 1, (draws[t.draw].flags & DRAW_MIRRORED) != 0u); }
    return fixed_sign(fixed_edge(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c)));
}

fn triangle_box(t: Triangle, corners: vec4i) -> vec4i {
    return corners;
}

fn point_is_turned(draw: u32, toward: f32) -> bool {
    return draw_topology(draw) == TOPOLOGY_POINTS && toward < 0.0;
}

//@ variant spread
//@ use lib/fixed
//@ use lib/triangle
//@ use glue/draws
//@ use variants/draw_records

// Of the triangle about a point its disc is shown.
override SHOWS_DISCS: bool = true;

fn triangle_is_point(draw: u32) -> bool {
    return draw_topology(draw) == TOPOLOGY_POINTS;
}

fn point_is_turned(draw: u32, toward: f32) -> bool {
    return triangle_is_point(draw) && toward < 0.0;
}

// A point on the screen.
struct Point {
    at: vec2i,
    reach: i32, // one unit more than the radius of its disc, or the least one where that stands for the pixel
    flags: u32, // those of its record, and VERTEX_LEFT where its disc leaves the guard band
}

// Radius of the largest disc, in pixels.
const POINT_MAX_PX = 32u;

// Radius of the least disc in units: half the diagonal of a pixel, rounded up.
fn point_least() -> u32 {
    return (182u * u32(grid_unit()) + 255u) >> 8u;
}

// The radius of a draw's discs where 1/w is `inv_w`, in units, rounded down: the product of two floats, exactly.
fn point_radius(draw: u32, inv_w: u32) -> u32 {
    let most = POINT_MAX_PX << SUBPIXEL_BITS;
    let factors = vec2u(bitcast<u32>(draw_point_radius(draw)), inv_w);
    let exponents = factors >> vec2u(23u);
    if exponents.x == 0u || exponents.y == 0u { return 0u; }
    let significands = (factors & vec2u(0x7fffffu)) | vec2u(0x800000u);
    let product = fixed_umul(significands.x, significands.y);
    // Sixteen bits of 46 are cut off here.
    let high = (product.hi << 16u) | (product.lo >> 16u);
    let shift = 284 - i32(exponents.x + exponents.y + SUBPIXEL_BITS);
    if shift >= 32 { return 0u; }
    if shift < 0 { return most; }
    return min(high >> u32(shift), most);
}

// The triangle of a segment: its first has the first end twice, its second the second.
fn line_spread(t: Triangle) -> Triangle {
    let ends = vec4i(vertex_at(t.a), vertex_at(t.c));
    let d = abs(ends.zw - ends.xy);
    let half = grid_unit() / 2;
    let aside = select(vec2i(half, 0), vec2i(0, half), d.x >= d.y);
    let farthest = max(max(abs(ends.x), abs(ends.y)), max(abs(ends.z), abs(ends.w)));
    var flags = (t.a.x | t.c.x) & 255u;
    // What would be clipped is left out.
    if flags != 0u || farthest > 8388607 - half { flags |= VERTEX_LEFT; }
    let a = line_corner(t.a, ends.xy - aside, flags);
    if ((t.id - draws[t.draw].first_triangle) & 1u) == 0u {
        let b = line_corner(t.a, ends.xy + aside, flags);
        return Triangle(a, b, line_corner(t.c, ends.zw + aside, flags), t.id, t.draw, t.entry, t.outline);
    }
    let b = line_corner(t.c, ends.zw + aside, flags);
    return Triangle(a, b, line_corner(t.c, ends.zw - aside, flags), t.id, t.draw, t.entry, t.outline);
}

fn line_corner(end: vec4u, at: vec2i, flags: u32) -> vec4u {
    return vec4u((bitcast<vec2u>(at) << vec2u(8u)) | vec2u(flags, 0u), end.zw);
}

// The disc of the snapped vertex of a point.
fn point_from(draw: u32, record: vec4u) -> Point {
    let radius = point_radius(draw, record.w);
    let reach = i32(select(radius + 1u, point_least(), radius < point_least()));
    let at = vertex_at(record);
    // What would reach out of the guard band is left out, as if it were clipped.
    let is_out = max(abs(at.x), abs(at.y)) > 8388607 - 2 * reach;
    return Point(at, reach, (record.x & 255u) | select(0u, VERTEX_LEFT, is_out));
}

fn triangle_spread(t: Triangle) -> Triangle {
    if draw_topology(t.draw) == TOPOLOGY_LINES { return line_spread(t); }
    if !triangle_is_point(t.draw) { return t; }
    return point_triangle(point_from(t.draw, t.a), t);
}

// The triangle about a point, whose sides its reach touches.
fn point_triangle(point: Point, t: Triangle) -> Triangle {
    // At least as wide as a root of 3 says, so that the sides do not cut the disc.
    let half = ((point.reach * 1774) >> 10u) + 1;
    let aside = select(half, -half, (draws[t.draw].flags & DRAW_MIRRORED) != 0u);
    let x = vec3i(point.at.x - aside, point.at.x + aside, point.at.x);
    let y = vec3i(point.at.y + point.reach, point.at.y + point.reach, point.at.y - 2 * point.reach);
    let xs = (bitcast<vec3u>(x) << vec3u(8u)) | vec3u(point.flags);
    let ys = bitcast<vec3u>(y) << vec3u(8u);
    let zw = t.a.zw;
    return Triangle(vec4u(xs.x, ys.x, zw), vec4u(xs.y, ys.y, zw), vec4u(xs.z, ys.z, zw), t.id, t.draw, t.entry, t.outline);
}

// The point that a triangle lies about.
fn point_of(t: Triangle) -> Point {
    let low = vertex_at(t.a);
    let top = vertex_at(t.c);
    let reach = (low.y - top.y) / 3;
    return Point(vec2i(top.x, low.y - reach), reach, t.a.x & 255u);
}

fn point_covers(t: Triangle, pixel: vec2i) -> bool {
    return !triangle_is_point(t.draw) || point_shows(point_of(t), pixel);
}

fn point_shows(point: Point, pixel: vec2i) -> bool {
    if point.reach == i32(point_least()) { return all((point.at >> vec2u(SUBPIXEL_BITS)) == pixel); }
    let radius = u32(point.reach - 1);
    let d = vec2u(abs(grid_sample(pixel) - point.at));
    if max(d.x, d.y) > radius { return false; }
    // The squares of a finer grid exceed a word.
    if SUBPIXEL_BITS > 8u {
        return !fixed_is_less(fixed_umul(radius, radius), fixed_add(fixed_umul(d.x, d.x), fixed_umul(d.y, d.y)));
    }
    return d.x * d.x + d.y * d.y <= radius * radius;
}

fn triangle_orientation(t: Triangle) -> i32 {
    return fixed_sign(fixed_edge(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c)));
}

// Boxes are not narrowed.
fn triangle_box(t: Triangle, corners: vec4i) -> vec4i {
    if !SHOWS_DISCS || !triangle_is_point(t.draw) { return corners; }
    let point = point_of(t);
    return vec4i(point.at - point.reach, point.at + point.reach);
}
