// Dot segments, edges: edges of triangles, as joints, morph targets and vertex effects move them.
//@ use lib/triangle
//@ use lib/attributes
//@ use lib/dots
//@ use variants/vertex_effects

// Draw, both vertices, triangle; vertices and triangle counted within the draw.
@group(0) @binding(23) var<storage, read> dot_segments: array<vec4u>;

fn dot_segment(segment: u32) -> SegmentEnds {
    let edge = dot_segments[segment];
    let class_of_bits = bit_class(position_bits(edge.x, edge.y)) | bit_class(position_bits(edge.x, edge.z));
    let triangle = draws[edge.x].first_triangle + edge.w;
    return SegmentEnds(
        vertex_effects_clip_of(edge.x, edge.y, triangle), vertex_effects_clip_of(edge.x, edge.z, triangle), class_of_bits == 0u);
}
