// A corner of a triangle before it is projected. Mirror of `effects::hooks::Vertex`, where each member is explained.

struct Vertex {
    position: vec3f,
    offset: vec3f,
    normal: vec3f,
    flat_normal: vec3f,
    center: vec3f,
    arm: vec3f,
    center_screen: vec2f,
    triangle: u32,
}
