// Draws: every instance with its matrices and where its bytes lie. Mirror of `gpu::uniforms::DrawRecord`.
//@ use slot/draws

struct Draw {
    clip_from_object: mat4x4f,
    world_from_object: mat4x4f,
    normal_from_object: mat4x4f, // cofactors: keeps the direction of plane normals
    base_color: vec4f,
    origin: vec4f,               // places are counted from here, where they are packed or relative to the eye
    step: vec4f,                 // what a packed place counts in
    first_vertex: u32,
    vertex_count: u32,
    first_triangle: u32,
    flags: u32,                  // and from bit 8 on the primitive that it shows
    topology: u32,
    index_offset: u32,
    index_format: u32,
    position_offset: u32,
    position_stride: u32,
    position_format: u32,
    normal_offset: u32,
    normal_stride: u32,
    normal_format: u32,
    color_offset: u32,
    color_stride: u32,
    color_format: u32,           // lanes in bits 8 and up; 0 where there is no colour
}

const DRAW_DOUBLE_SIDED = 1u;
const DRAW_MIRRORED = 2u;
const DRAW_PARTICLES = 4u;
