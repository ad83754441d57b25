// Dots: numbered along all lines. A stretch is a run of dots on one segment, and a dot is a stretch and its place there;
// where it lies in the picture follows from the ends of the segment in clip space.
//@ use common/dot_frame
//@ use common/vertex
//@ use effects/dots

// Mirror of `gpu::dots::DotRunRecord`.
struct DotRun {
    segment: u32,
    first: u32,   // number of its first dot
    count: u32,
    start: f32,   // where the first dot lies, as a share of the segment
    step: f32,    // share from dot to dot
}

@group(0) @binding(21) var<storage, read> dot_runs: array<DotRun>;
@group(0) @binding(22) var<storage, read> dot_ends: array<vec4f>;

// A value as it is, which no compiler fuses with what is done to it next: so every pass places a dot alike.
fn dots_rounded(v: vec4f) -> vec4f {
    return bitcast<vec4f>(bitcast<vec4u>(v) ^ vec4u(dot_frame.zero));
}

// A dot in clip space.
fn dots_clip(stretch: u32, place: u32) -> vec4f {
    let s = dot_runs[stretch];
    let begin = dot_ends[2u * s.segment];
    let share = s.start + dots_rounded(vec4f(f32(place) * s.step)).x;
    return begin + dots_rounded((dot_ends[2u * s.segment + 1u] - begin) * share);
}

// How far rounding may carry the dots of a stretch in clip space, in whatever order and fusion a pass computes them.
fn dots_slack(stretch: u32) -> vec4f {
    let segment = dot_runs[stretch].segment;
    return (abs(dot_ends[2u * segment]) + abs(dot_ends[2u * segment + 1u])) * 1e-6;
}

// A dot as it is drawn: snapped once, as vertices are; flags alone where it lies before the near plane or beyond the far one.
fn dots_record(clip: vec4f) -> vec4u {
    let is_between = clip.z <= clip.w && clip.w > 0.0 && clip.z >= 0.0;
    let inv_w = 1.0 / select(1.0, clip.w, is_between);
    let scaled = vec2i(clamp(round(clip.xy * inv_w * dot_frame.center), vec2f(-16777216.0), vec2f(16777216.0)));
    let at = vec2i(dot_frame.center) + scaled * vec2i(1, -1);
    return vertex_record(0u, is_between, at, bitcast<u32>(clip.z * inv_w), bitcast<u32>(inv_w));
}

// DotRun and place of the dot of this number.
fn dots_find(number: u32) -> vec2u {
    var low = 0u;
    var high = dot_frame.dot_runs;
    // As many halvings as an index has bits.
    for (var i = 0u; i < 32u && high - low > 1u; i += 1u) {
        let middle = (low + high) / 2u;
        if dot_runs[middle].first <= number { low = middle; } else { high = middle; }
    }
    return vec2u(low, number - dot_runs[low].first);
}
