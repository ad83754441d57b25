// Skinning, none: no joint holds a vertex, shapes alone move it.

struct Skinning { spare: u32 }

fn skinning_of(deform: u32, vertex: u32) -> Skinning {
    return Skinning(0u);
}

fn skinning_place(s: Skinning, p: vec3f) -> vec3f {
    return p;
}

fn skinning_normal(s: Skinning, n: vec3f) -> vec3f {
    return n;
}
