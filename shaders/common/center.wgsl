// The middle of a triangle, in the world and in the picture.
//@ use common/frame
//@ use common/transform

fn center_world(draw: u32, at: vec3u) -> vec3f {
    let a = vertex_position(transform_bits(draw, at.x), 0u);
    let b = vertex_position(transform_bits(draw, at.y), 0u);
    let c = vertex_position(transform_bits(draw, at.z), 0u);
    return center_of(draw, a, b, c);
}

// The same from corners in object space.
fn center_of(draw: u32, a: vec3f, b: vec3f, c: vec3f) -> vec3f {
    return (draws[draw].world_from_object * vec4f((a + b + c) / 3.0, 1.0)).xyz;
}

// 0 to 1 in the picture, of a triangle that is not clipped: corners weighted by w, as the middle of the plane is.
fn center_whole(a: vec4u, b: vec4u, c: vec4u) -> vec2f {
    let w = 1.0 / bitcast<vec3f>(vec3u(a.w, b.w, c.w));
    let sum = vec2f(vertex_at(a)) * w.x + vec2f(vertex_at(b)) * w.y + vec2f(vertex_at(c)) * w.z;
    return sum / ((w.x + w.y + w.z) * 2.0 * frame.center);
}

// The same from clip-space corners; `otherwise` where the middle lies behind the eye.
fn center_clipped(a: vec4f, b: vec4f, c: vec4f, otherwise: vec2f) -> vec2f {
    let w = a.w + b.w + c.w;
    let ndc = (a.xy + b.xy + c.xy) / select(1.0, w, w > 0.0);
    return select(otherwise, vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y), w > 0.0);
}
