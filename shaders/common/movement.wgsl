// Movement: what the vertex effects make of a corner, in the world and in clip space. They say how far it moves, not where
// it ends, so that a vertex that stays keeps its bits, and one far from the origin loses none.
//@ use common/frame
//@ use common/moved
//@ use common/transform
//@ use common/normal
//@ use glue/vertex

const MOVEMENT_LIMIT_M = 1099511627776.0; // 2^40: beyond it products might overflow

fn movement_held(v: vec3f) -> vec3f {
    return clamp(v, vec3f(-MOVEMENT_LIMIT_M), vec3f(MOVEMENT_LIMIT_M));
}

// A vertex before any effect, as if it had no triangle.
fn movement_vertex(draw: u32, vertex: u32, p: vec3f) -> Vertex {
    var v: Vertex;
    v.position = movement_held((draws[draw].world_from_object * vec4f(p, 1.0)).xyz);
    v.normal = normal_direction(movement_normal(draw, vertex));
    v.center = v.position;
    return v;
}

// The stored normal in the world, of any length; zero where there is none.
fn movement_normal(draw: u32, vertex: u32) -> vec3f {
    let stored = normal_gated(normal_bits(draw, vertex));
    return (draws[draw].normal_from_object * vec4f(stored.xyz, 0.0)).xyz;
}

// Clip-space position of a corner; `p` is the vertex in object space.
fn movement_clip(draw: u32, vertex: u32, id: u32, p: vec3f) -> vec4f {
    let offset = movement_held(movement_corner(draw, vertex, id, p).offset);
    let m = frame.clip_from_world;
    let clip = transform_clip(draw, p) + (m[0] * offset.x + m[1] * offset.y + m[2] * offset.z);
    // What passes the far plane of parallel rays is held on it: depths below 0 are none.
    return vec4f(clip.xy, max(clip.z, 0.0), clip.w);
}
