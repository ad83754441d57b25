// The surface at a visible sample, as surface effects see it. Mirrors `effects::hooks::Surface`, which explains each member.

struct Surface {
    color: vec4f,
    glow: vec3f,
    position: vec3f,
    normal: vec3f,
    flat_normal: vec3f,
    view: vec3f,
    center: vec3f,
    center_screen: vec2f,
    screen: vec2f,
    pixel: vec2f,
    barycentrics: vec3f,
    edge_distance_px: vec3f,
    depth_m: f32,
    pixel_size_m: f32,
    flat_depth_m: f32,
    depth_range_m: vec2f,
    triangle_id: u32,
    rank: f32,
    lit: f32,
}
