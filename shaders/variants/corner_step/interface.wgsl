// Corner steps: what a corner knows before vertex effects are applied, beyond its own vertex.
// Chosen by the stack: triangle where an effect moves corners triangle by triangle.
//@ steps fn corner_step(v: Vertex, draw: u32, id: u32, p: vec3f) -> Vertex
