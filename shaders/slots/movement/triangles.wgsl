// Movement, triangles: effects move a corner by what they know of its triangle.
//@ use common/movement
//@ use common/center
//@ use common/topology
//@ use slot/screen

// A corner as the effects leave it; `p` is the vertex in object space, `id` its triangle.
fn movement_corner(draw: u32, vertex: u32, id: u32, p: vec3f) -> Vertex {
    var v = movement_vertex(draw, vertex, p);
    let at = triangle_vertices(draw, id - draws[draw].first_triangle);
    let a = movement_place(draw, at.x);
    let b = movement_place(draw, at.y);
    let c = movement_place(draw, at.z);
    let plane = draws[draw].normal_from_object * vec4f(normal_of_plane(a, b, c), 0.0);
    v.flat_normal = normal_direction(plane.xyz);
    v.center = movement_held(center_of(draw, a, b, c));
    v.arm = (draws[draw].world_from_object * vec4f(((p - a) + (p - b) + (p - c)) / 3.0, 0.0)).xyz;
    let middle = transform_clip(draw, (a + b + c) / 3.0);
    v.center_screen = screen_of(v.center, center_clipped(middle, middle, middle, vec2f(0.5)));
    v.triangle = id;
    return glue_vertex(v);
}

// A vertex in object space; the origin where a lane is refused.
fn movement_place(draw: u32, vertex: u32) -> vec3f {
    let bits = transform_bits(draw, vertex);
    return vertex_position(bits, vertex_gate(bits));
}
