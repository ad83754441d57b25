// Vertex effects: what the vertex effects of the stack do to the corners of triangles.
// Chosen by the stack: applied where an effect moves vertices. Default: the functions below, which move nothing.
//@ use lib/attributes
//@ use lib/geometry

// Clip-space position of a corner after the effects. `p` is the vertex in object space, `id` its triangle.
//@ declare fn vertex_effects_clip(draw: u32, vertex: u32, id: u32, p: vec3f) -> vec4f
fn vertex_effects_clip(draw: u32, vertex: u32, id: u32, p: vec3f) -> vec4f {
    return transform_clip(draw, p);
}

// The same of a vertex that was not rejected.
//@ declare fn vertex_effects_clip_of(draw: u32, vertex: u32, id: u32) -> vec4f
fn vertex_effects_clip_of(draw: u32, vertex: u32, id: u32) -> vec4f {
    return vertex_effects_clip(draw, vertex, id, floats_of_class(position_bits(draw, vertex), 0u));
}

// Before samples of a triangle are shaded: computes what they share.
//@ declare fn vertex_effects_begin(id: u32, draw: u32, at: vec3u)
fn vertex_effects_begin(id: u32, draw: u32, at: vec3u) {}

// Interpolated and flat normal after the effects, before they are turned towards the viewer, given those of the file.
//@ declare fn vertex_effects_normals(smooth_normal: vec3f, flat_normal: vec3f, weights: vec3f) -> mat2x3f
fn vertex_effects_normals(smooth_normal: vec3f, flat_normal: vec3f, weights: vec3f) -> mat2x3f {
    return mat2x3f(smooth_normal, flat_normal);
}
