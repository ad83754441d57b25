// Shapes, none: no mesh is mixed from several.

fn shapes_place(deform: u32, vertex: u32, p: vec3f) -> vec3f {
    return p;
}

fn shapes_normal(deform: u32, vertex: u32, n: vec3f) -> vec3f {
    return n;
}
