// Inflate: every vertex moves along its own normal, so that a smooth surface swells or shrinks without a tear.
//@ use lib/vertex

struct Inflate {
    amount_m: f32,
}

fn inflate(vertex: Vertex, p: Inflate) -> Vertex {
    var v = vertex;
    v.offset += v.normal * p.amount_m;
    return v;
}
