// Skinning: how joints move a vertex.
// Chosen by the accuracy axis `skinning` where a mesh has joints. Default: the functions below, for morph targets alone.
//
// The motion of one vertex.
//@ declare struct Skinning
struct Skinning { spare: u32 }

// Of a vertex of a deformed draw.
//@ declare fn skinning_of(deform: u32, vertex: u32) -> Skinning
fn skinning_of(deform: u32, vertex: u32) -> Skinning {
    return Skinning(0u);
}

//@ declare fn skinning_position(s: Skinning, p: vec3f) -> vec3f
fn skinning_position(s: Skinning, p: vec3f) -> vec3f {
    return p;
}

// A normal of any length.
//@ declare fn skinning_normal(s: Skinning, n: vec3f) -> vec3f
fn skinning_normal(s: Skinning, n: vec3f) -> vec3f {
    return n;
}
