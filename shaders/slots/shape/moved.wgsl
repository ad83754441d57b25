// Shape, moved: normals of a triangle whose corners the vertex effects have moved.
//@ use common/surface
//@ use common/movement
//@ use slot/movement

// What the samples of a triangle share.
struct Shape {
    is_deformed: bool,     // the plane is no longer the file's
    flat_normal: vec3f,
    is_turned: bool,   // the corners' normals are no longer the file's
    a: vec4f,          // as `normal_gated`
    b: vec4f,
    c: vec4f,
}

var<private> shape: Shape;

// Told once for a triangle, before its samples are visited: drivers take minutes over vertex effects in the middle of a loop.
fn shape_begin(id: u32, draw: u32, at: vec3u) {
    let pa = vertex_position(transform_bits(draw, at.x), 0u);
    let pb = vertex_position(transform_bits(draw, at.y), 0u);
    let pc = vertex_position(transform_bits(draw, at.z), 0u);
    // A loop, since compilers copy what the effects do to a corner to wherever it is called.
    var corners: array<Vertex, 3>;
    var places = array(pa, pb, pc);
    for (var i = 0u; i < 3u; i += 1u) { corners[i] = movement_corner(draw, at[i], id, places[i]); }
    let a = corners[0];
    let b = corners[1];
    let c = corners[2];
    shape.is_deformed = any(a.offset != b.offset) || any(a.offset != c.offset);
    let m = draws[draw].world_from_object;
    let ab = (m * vec4f(pb - pa, 0.0)).xyz + (b.offset - a.offset);
    let ac = (m * vec4f(pc - pa, 0.0)).xyz + (c.offset - a.offset);
    let plane = normal_direction(normal_of_plane(vec3f(0.0), ab, ac));
    shape.flat_normal = select(plane, -plane, (draws[draw].flags & DRAW_MIRRORED) != 0u);

    let na = movement_normal(draw, at.x);
    let nb = movement_normal(draw, at.y);
    let nc = movement_normal(draw, at.z);
    shape.is_turned = any(a.normal != normal_direction(na)) || any(b.normal != normal_direction(nb)) || any(c.normal != normal_direction(nc));
    // Turned normals keep the lengths by which the file weighs them.
    shape.a = vec4f(a.normal * length(na), normal_gated(normal_bits(draw, at.x)).w);
    shape.b = vec4f(b.normal * length(nb), normal_gated(normal_bits(draw, at.y)).w);
    shape.c = vec4f(c.normal * length(nc), normal_gated(normal_bits(draw, at.z)).w);
}

// Normals before they are turned to the viewer's side. What no effect touches keeps its bits: the plane of a triangle that
// is only carried along, and the interpolated normal where no corner's is turned.
fn shape_of(surface: Surface, weights: vec3f) -> Surface {
    var s = surface;
    if shape.is_deformed { s.flat_normal = shape.flat_normal; }
    if shape.is_turned { s.normal = normal_direction(normal_mixed(shape.a, shape.b, shape.c, weights)); }
    return s;
}
