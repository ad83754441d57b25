// A corner of a triangle, as vertex effects see it. Mirrors `effects::hooks::Vertex`, which explains each member.

struct Vertex {
    position: vec3f,
    offset: vec3f,
    normal: vec3f,
    flat_normal: vec3f,
    center: vec3f,
    arm: vec3f,
    center_screen: vec2f,
    triangle: u32,
    cell_px: u32,
}

const WORLD_LIMIT_M = 1099511627776.0; // 2^40: products of larger values might overflow

fn clamp_world(v: vec3f) -> vec3f {
    return clamp(v, vec3f(-WORLD_LIMIT_M), vec3f(WORLD_LIMIT_M));
}
