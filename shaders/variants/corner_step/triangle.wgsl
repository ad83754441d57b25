// Corner step, triangle: normal and center of the corner's triangle, before any effect. `p` is the corner in object space.
//@ use lib/triangle
//@ use lib/vertex
//@ use lib/attributes
//@ use lib/geometry

fn corner_step_triangle(v: Vertex, draw: u32, id: u32, p: vec3f) -> Vertex {
    var corner = v;
    let at = triangle_vertices(draw, id - draws[draw].first_triangle);
    let a = corner_position(draw, at.x);
    let b = corner_position(draw, at.y);
    let c = corner_position(draw, at.z);
    let plane = draws[draw].normal_from_object * vec4f(normal_of_plane(a, b, c), 0.0);
    corner.flat_normal = normal_direction(plane.xyz);
    corner.center = clamp_world(center_of(draw, a, b, c));
    corner.arm = (draws[draw].world_from_object * vec4f(((p - a) + (p - b) + (p - c)) / 3.0, 0.0)).xyz;
    let middle = transform_clip(draw, (a + b + c) / 3.0);
    corner.center_screen = center_in_picture(corner.center, center_clipped(middle, middle, middle, vec2f(0.5)));
    corner.triangle = id;
    return corner;
}

// A vertex in object space; the origin where it is rejected.
fn corner_position(draw: u32, vertex: u32) -> vec3f {
    let bits = position_bits(draw, vertex);
    return floats_of_class(bits, bit_class(bits));
}
