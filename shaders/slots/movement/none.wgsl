// Movement, none: vertices stay where the file and the placement put them.
//@ use common/transform

// Clip-space position of a corner; `p` is the vertex in object space.
fn movement_clip(draw: u32, vertex: u32, id: u32, p: vec3f) -> vec4f {
    return transform_clip(draw, p);
}
