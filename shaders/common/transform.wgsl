// Object to clip space, from the stored bytes: shared by the projection, the clipper and the resolve.
//@ use common/draws
//@ use common/pull
//@ use common/vertex
//@ use slot/movement

// Every draw's positions are f32, as glTF's core demands.
override F32_POSITIONS: bool = false;

fn transform_bits(draw: u32, vertex: u32) -> vec3u {
    let byte = draws[draw].position_offset + vertex * draws[draw].position_stride;
    if F32_POSITIONS {
        let word = byte / 4u;
        return vec3u(vertex_bytes[word], vertex_bytes[word + 1u], vertex_bytes[word + 2u]);
    }
    return pull_bits3(draws[draw].position_format, byte);
}

fn transform_clip(draw: u32, p: vec3f) -> vec4f {
    let m = draws[draw].clip_from_object;
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}

// Clip-space position of a corner whose record was not rejected, as the effects leave it; `id` is its triangle.
fn transform_vertex(draw: u32, vertex: u32, id: u32) -> vec4f {
    return movement_clip(draw, vertex, id, vertex_position(transform_bits(draw, vertex), 0u));
}
