// Dot ends, edges: corners of triangles, wherever joints and effects take them.
//@ use common/transform

// Draw, both vertices, triangle; vertices and triangle counted within the draw.
@group(0) @binding(23) var<storage, read> dot_segments: array<vec4u>;

struct DotEnds { begin: vec4f, end: vec4f, is_sound: bool }

fn dot_ends_of(segment: u32) -> DotEnds {
    let edge = dot_segments[segment];
    let gate = vertex_gate(transform_bits(edge.x, edge.y)) | vertex_gate(transform_bits(edge.x, edge.z));
    let triangle = draws[edge.x].first_triangle + edge.w;
    return DotEnds(transform_vertex(edge.x, edge.y, triangle), transform_vertex(edge.x, edge.z, triangle), gate == 0u);
}
