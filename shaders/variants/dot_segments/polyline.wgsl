// Dot segments, polyline: a line that the preset defines. Only the scene's spin moves it.
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
