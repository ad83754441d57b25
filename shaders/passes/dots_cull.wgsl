// Dots cull: 64 dot_runs to a workgroup. Those outside the view are left out whole, the others are thinned by their
// nearest end, and the dots that remain are shared out evenly among the invocations; those that may show are kept in a list
// without gaps, in whatever order. It keeps a few too many, never one too few: the draw decides.
//@ use common/frame
//@ use common/dots

@group(0) @binding(24) var<storage, read_write> dot_list: array<vec2u>;
@group(0) @binding(25) var<storage, read_write> dot_count: atomic<u32>;

const CULL_GROUP = 64u;
// Rounding of 1/w, in steps of its bits.
const CULL_STEPS = 64u;

// How many dots the dot_runs up to this one may show.
var<workgroup> sums: array<u32, 64>;
// Place of the first such dot in its stretch, and how often their numbers can be halved.
var<workgroup> firsts: array<vec2u, 64>;
var<workgroup> kept: atomic<u32>;
var<workgroup> base: u32;

// Room beyond the picture for a dot's edge, in half pictures.
fn cull_margin() -> vec2f {
    return vec2f(f32(dot_frame.radius) + 512.0) / dot_frame.center;
}

// Distances to the planes of the view, positive inside; where rays are parallel a far plane is one of them.
fn cull_inside(clip: vec4f, slack: vec4f) -> array<f32, 6> {
    let wide = clip.w * (1.0 + cull_margin()) + slack.w * 2.0;
    return array<f32, 6>(
        wide.x - clip.x + slack.x, wide.x + clip.x + slack.x, wide.y - clip.y + slack.y, wide.y + clip.y + slack.y,
        clip.w - clip.z + slack.w + slack.z, clip.z + slack.z,
    );
}

// Does the whole way between two points lie outside one plane?
fn cull_is_outside(a: vec4f, b: vec4f, slack: vec4f) -> bool {
    var at_a = cull_inside(a, slack);
    var at_b = cull_inside(b, slack);
    var is_outside = false;
    for (var i = 0u; i < 6u; i += 1u) { is_outside = is_outside || (at_a[i] < 0.0 && at_b[i] < 0.0); }
    return is_outside;
}

// How often the gap has surely halved at a depth; not at all where it may be that of the eye.
fn cull_halved(w: f32) -> u32 {
    if w <= 0.0 { return 0u; }
    return dots_halved(bitcast<u32>(1.0 / w) + CULL_STEPS, dot_frame.fade_from, dot_frame.levels);
}

// How many dots a stretch may show, the place of the first and their level.
fn cull_dot_run(id: u32) -> vec3u {
    let s = dot_runs[id];
    let a = dots_clip(id, 0u);
    let b = dots_clip(id, s.count - 1u);
    let slack = dots_slack(id);
    if cull_is_outside(a, b, slack) { return vec3u(0u); }
    let level = cull_halved(min(a.w, b.w) - slack.w) >> DOTS_STEPS;
    let stride = 1u << level;
    let first = (stride - (s.first & (stride - 1u))) & (stride - 1u);
    if first >= s.count { return vec3u(0u); }
    return vec3u(((s.count - 1u - first) >> level) + 1u, first, level);
}

// The stretch of the workgroup to which the candidate of this number belongs.
fn cull_triangle(candidate: u32) -> u32 {
    var low = 0u;
    for (var skip = 32u; skip > 0u; skip /= 2u) {
        if sums[low + skip - 1u] <= candidate { low += skip; }
    }
    return low;
}

@compute @workgroup_size(CULL_GROUP)
fn dots_cull(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let first_dot_run = frame_invocation(group, groups, 0u, CULL_GROUP);
    var own = vec3u(0u);
    if first_dot_run + lane < dot_frame.dot_runs { own = cull_dot_run(first_dot_run + lane); }
    sums[lane] = own.x;
    firsts[lane] = own.yz;
    // Every invocation adds what stands 1, 2, 4 … before it.
    for (var reach = 1u; reach < CULL_GROUP; reach *= 2u) {
        workgroupBarrier();
        var before = 0u;
        if lane >= reach { before = sums[lane - reach]; }
        workgroupBarrier();
        sums[lane] += before;
    }
    let candidates = workgroupUniformLoad(&sums[CULL_GROUP - 1u]);
    for (var done = 0u; done < candidates; done += CULL_GROUP) {
        if lane == 0u { atomicStore(&kept, 0u); }
        workgroupBarrier();
        let candidate = done + lane;
        var entry = vec2u(0u);
        var slot = 0u;
        var may_show = false;
        if candidate < candidates {
            let at = cull_triangle(candidate);
            var before = 0u;
            if at > 0u { before = sums[at - 1u]; }
            entry = vec2u(first_dot_run + at, firsts[at].x + ((candidate - before) << firsts[at].y));
            let clip = dots_clip(entry.x, entry.y);
            let slack = dots_slack(entry.x);
            let halved = cull_halved(clip.w - slack.w);
            let number = dot_runs[entry.x].first + entry.y;
            may_show = !cull_is_outside(clip, clip, slack) && firstTrailingBit(number) >= (halved >> DOTS_STEPS);
            if may_show { slot = atomicAdd(&kept, 1u); }
        }
        workgroupBarrier();
        if lane == 0u { base = atomicAdd(&dot_count, atomicLoad(&kept)); }
        let first_slot = workgroupUniformLoad(&base);
        if may_show { dot_list[first_slot + slot] = entry; }
    }
}
