// Dots: numbered along all lines. A dot run is a sequence of dots on one segment; a dot is a run and its index in it. Where a
// dot lies on screen follows from the clip-space ends of its segment. Mirrors `gpu::records::{DotFrame, DotRunRecord}`.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/snap

struct DotFrame {
    clip_from_scene: mat4x4f, // for lines that belong to no mesh
    ink: vec4f,               // gamma-encoded, alpha is the strength
    center: vec2f,            // half the picture in units of 1/256 px
    dots: u32,                // of all lines
    dot_runs: u32,
    segments: u32,
    fade_from: u32,           // bits of the 1/w at which dots of level 0 begin to fade
    fade_rate: u32,
    levels: u32,
    radius: u32,              // units of 1/256 px
    bias: u32,                // how far behind the surface a dot still counts as on it, in steps of the depth's bits
    hidden: u32,              // strength of a hidden dot, 0 to 256
    model: u32,               // 1: the model shows beneath the dots
    first_probed: u32,        // dot of the first record that is read back
    zero: u32,                // 0, unknown to the compiler
}

@group(0) @binding(20) var<uniform> dot_frame: DotFrame;

struct DotRun {
    segment: u32,
    first: u32,   // number of its first dot
    count: u32,
    start: f32,   // position of the first dot along the segment, 0 to 1
    step: f32,    // distance from dot to dot along the segment
}

@group(0) @binding(21) var<storage, read> dot_runs: array<DotRun>;
//@ binding @group(0) @binding(22) var<storage, read> dot_ends: array<vec4f>;

// The value unchanged, but protected from fusion with the next operation, so that every pass computes the same position.
fn dots_rounded(v: vec4f) -> vec4f {
    return bitcast<vec4f>(bitcast<vec4u>(v) ^ vec4u(dot_frame.zero));
}

// Clip-space position of a dot.
fn dots_clip(run: u32, index: u32) -> vec4f {
    let r = dot_runs[run];
    let begin = dot_ends[2u * r.segment];
    let fraction = r.start + dots_rounded(vec4f(f32(index) * r.step)).x;
    return begin + dots_rounded((dot_ends[2u * r.segment + 1u] - begin) * fraction);
}

// Bound on the rounding of the clip-space positions of a run's dots, for every order and fusion that a pass may use.
fn dots_error(run: u32) -> vec4f {
    let segment = dot_runs[run].segment;
    return (abs(dot_ends[2u * segment]) + abs(dot_ends[2u * segment + 1u])) * 1e-6;
}

// A dot as a snapped vertex; only flags where it lies between the eye and the near plane or beyond the far plane.
fn dots_record(clip: vec4f) -> vec4u {
    let is_between = clip.z <= clip.w && clip.w > 0.0 && clip.z >= 0.0;
    let inv_w = 1.0 / select(1.0, clip.w, is_between);
    let scaled = vec2i(clamp(round(clip.xy * inv_w * dot_frame.center), vec2f(-16777216.0), vec2f(16777216.0)));
    let at = vec2i(dot_frame.center) + scaled * vec2i(1, -1);
    return snap_record(0u, is_between, at, bitcast<u32>(clip.z * inv_w), bitcast<u32>(inv_w));
}

// Run and index of the dot of this number.
fn dots_find(number: u32) -> vec2u {
    var search = search_begin(dot_frame.dot_runs);
    for (var i = 0u; i < SEARCH_STEPS && search_is_open(search); i += 1u) {
        search = search_narrow(search, dot_runs[search_middle(search)].first <= number);
    }
    return vec2u(search.low, number - dot_runs[search.low].first);
}

// Clip-space ends of a segment.
struct SegmentEnds {
    begin: vec4f,
    end: vec4f,
    is_valid: bool, // both ends have a position
}
