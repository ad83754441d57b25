// Draws: every instance with its matrices and where its bytes lie. Twin of `gpu::uniforms::DrawRecord`.
//@ use common/frame

struct Draw {
    clip_from_object: mat4x4f,
    world_from_object: mat4x4f,
    normal_from_object: mat4x4f, // cofactors: keeps the direction of plane normals
    base_color: vec4f,
    first_vertex: u32,
    vertex_count: u32,
    first_triangle: u32,
    flags: u32,
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

@group(0) @binding(1) var<storage, read> draws: array<Draw>;

override SINGLE_DRAW: bool = false;

// The draw that triangle `id` belongs to: the last one that does not begin after it.
fn draws_of_triangle(id: u32) -> u32 {
    if SINGLE_DRAW { return 0u; }
    var low = 0u;
    var high = frame.draw_count;
    for (var step = 0u; step < 32u && high - low > 1u; step += 1u) {
        let middle = (low + high) / 2u;
        if draws[middle].first_triangle <= id { low = middle; } else { high = middle; }
    }
    return low;
}

fn draws_of_vertex(id: u32) -> u32 {
    if SINGLE_DRAW { return 0u; }
    var low = 0u;
    var high = frame.draw_count;
    for (var step = 0u; step < 32u && high - low > 1u; step += 1u) {
        let middle = (low + high) / 2u;
        if draws[middle].first_vertex <= id { low = middle; } else { high = middle; }
    }
    return low;
}
