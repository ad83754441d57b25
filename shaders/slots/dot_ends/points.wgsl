// Dot ends, points: a line of the preset's own, which nothing moves but the scene's spin.

struct DotPoints { begin: vec4f, end: vec4f }

@group(0) @binding(23) var<storage, read> dot_segments: array<DotPoints>;

struct DotEnds { begin: vec4f, end: vec4f, is_sound: bool }

fn dot_ends_of(segment: u32) -> DotEnds {
    return DotEnds(dot_ends_place(dot_segments[segment].begin), dot_ends_place(dot_segments[segment].end), true);
}

fn dot_ends_place(p: vec4f) -> vec4f {
    let m = dot_frame.clip_from_scene;
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}
