// Morph targets: offsets added to a vertex, before joints move it.
// Chosen where a mesh has morph targets. Default: the functions below, which add nothing.

//@ declare fn morph_targets_position(deform: u32, vertex: u32, p: vec3f) -> vec3f
fn morph_targets_position(deform: u32, vertex: u32, p: vec3f) -> vec3f {
    return p;
}

//@ declare fn morph_targets_normal(deform: u32, vertex: u32, n: vec3f) -> vec3f
fn morph_targets_normal(deform: u32, vertex: u32, n: vec3f) -> vec3f {
    return n;
}
