// Dot segments: the lines along which dots lie.
// Chosen by the parameter dots.lines: polyline for that value, edges for all others. Default: edges.
//
// Clip-space ends of a segment.
//@ declare fn dot_segment(segment: u32) -> SegmentEnds

//@ variant edges
// Edges of triangles, as joints, morph targets and vertex effects move them.
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

//@ variant polyline
// A line that the preset defines. Only the scene's spin moves it.
//@ use lib/dots

struct DotPoints { begin: vec4f, end: vec4f }

@group(0) @binding(23) var<storage, read> dot_segments: array<DotPoints>;

fn dot_segment(segment: u32) -> SegmentEnds {
    return SegmentEnds(dot_segment_clip(dot_segments[segment].begin), dot_segment_clip(dot_segments[segment].end), true);
}

fn dot_segment_clip(p: vec4f) -> vec4f {
    let m = dot_frame.clip_from_scene;
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}
