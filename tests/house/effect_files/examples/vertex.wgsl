struct Ink { @range(0.0, 0.5, 0.1) @unit(m) helper: f32 }
fn helper(x: f32) -> f32 { return x * 0.5; }
fn hook_vertex(vertex: Vertex, p: Ink) -> Vertex { var v = vertex; v.offset += v.normal * helper(p.helper); return v; }
fn limit(surface: Surface, p: Ink) -> Surface { var s = surface; for (var i = 0; i < 3; i++) { s.rank += helper(p.helper); } return s; }
