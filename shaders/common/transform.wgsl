// Object to clip space, from the stored bytes: shared by the projection, the clipper and the resolve.
//@ use common/draws
//@ use common/vertex
//@ use slot/movement
//@ use slot/positions

// Places are taken from the draw's origin, near the eye, before they meet its matrix.
override IS_RELATIVE: bool = false;

// A vertex in object space, as bits: NaN or 2^40 and more in a lane where it is refused.
fn transform_bits(draw: u32, vertex: u32) -> vec3u {
    return positions_bits(draw, vertex);
}

fn transform_clip(draw: u32, place: vec3f) -> vec4f {
    var p = place;
    if IS_RELATIVE { p -= draws[draw].origin.xyz; }
    let m = draws[draw].clip_from_object;
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}

// Clip-space position of a corner whose record was not rejected, as the effects leave it; `id` is its triangle.
fn transform_vertex(draw: u32, vertex: u32, id: u32) -> vec4f {
    return movement_clip(draw, vertex, id, vertex_position(transform_bits(draw, vertex), 0u));
}
