// Inflate: moves every vertex along its own normal: the model swells or shrinks.
//@ use lib/vertex

struct Inflate {
    /// How far every vertex moves along its normal; negative: inwards.
    @range(-0.5, 0.5, 0.05) @hard(-1000, 1000) @unit(m) amount_m: f32,
}

fn inflate(vertex: Vertex, p: Inflate) -> Vertex {
    var v = vertex;
    v.offset += v.normal * p.amount_m;
    return v;
}
