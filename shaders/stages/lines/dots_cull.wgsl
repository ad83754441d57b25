// dots_cull: up to 64 dot runs per workgroup; on a card fewer, where there are too few runs to occupy it. Runs outside the view
// volume are left out as a whole, the others are thinned by their nearest end, and the remaining dots are divided evenly among the
// invocations; those that may show are listed without gaps, in any order. A few too many are listed, never one too few:
// dots_draw decides.
//@ use lib/frame
//@ use lib/dots
//@ use effects/dots

@group(0) @binding(24) var<storage, read_write> dot_list: array<vec2u>;
@group(0) @binding(25) var<storage, read_write> dot_count: atomic<u32>;

const CULL_GROUP = 64u;
// Bound on the rounding of 1/w, in steps of its bits.
const CULL_STEPS = 64u;

// How many dots the runs up to and with this one may show.
var<workgroup> sums: array<u32, 64>;
// Index of the first such dot in its run, and how often the dots' numbers can be halved.
var<workgroup> firsts: array<vec2u, 64>;
var<workgroup> listed: atomic<u32>;
var<workgroup> base: u32;

// Margin around the picture for the radius of a dot, in half pictures.
fn cull_margin() -> vec2f {
    return vec2f(f32(dot_frame.radius) + 512.0) / dot_frame.center;
}

// Distances to the planes of the view volume, positive inside; an orthographic view has a far plane.
fn cull_inside(clip: vec4f, error: vec4f) -> array<f32, 6> {
    let wide = clip.w * (1.0 + cull_margin()) + error.w * 2.0;
    return array<f32, 6>(
        wide.x - clip.x + error.x, wide.x + clip.x + error.x, wide.y - clip.y + error.y, wide.y + clip.y + error.y,
        clip.w - clip.z + error.w + error.z, clip.z + error.z,
    );
}

// Does the whole line between two points lie outside one plane?
fn cull_is_outside(a: vec4f, b: vec4f, error: vec4f) -> bool {
    var at_a = cull_inside(a, error);
    var at_b = cull_inside(b, error);
    var is_outside = false;
    for (var i = 0u; i < 6u; i += 1u) { is_outside = is_outside || (at_a[i] < 0.0 && at_b[i] < 0.0); }
    return is_outside;
}

// How often the gap has certainly halved at a depth; 0 where the depth may be that of the eye.
fn cull_halved(w: f32) -> u32 {
    if w <= 0.0 { return 0u; }
    return dots_halved(bitcast<u32>(1.0 / w) + CULL_STEPS, dot_frame.fade_from, dot_frame.levels);
}

// How many dots a run may show, the index of the first and their level.
fn cull_run(id: u32) -> vec3u {
    let r = dot_runs[id];
    let a = dots_clip(id, 0u);
    let b = dots_clip(id, r.count - 1u);
    let error = dots_error(id);
    if cull_is_outside(a, b, error) { return vec3u(0u); }
    let level = cull_halved(min(a.w, b.w) - error.w) >> DOTS_STEPS;
    let stride = 1u << level;
    let first = (stride - (r.first & (stride - 1u))) & (stride - 1u);
    if first >= r.count { return vec3u(0u); }
    return vec3u(((r.count - 1u - first) >> level) + 1u, first, level);
}

// The run of the workgroup that the candidate of this number belongs to.
fn cull_run_of(candidate: u32) -> u32 {
    var low = 0u;
    for (var skip = 32u; skip > 0u; skip /= 2u) {
        if sums[low + skip - 1u] <= candidate { low += skip; }
    }
    return low;
}

@compute @workgroup_size(CULL_GROUP)
fn dots_cull(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let groups = workgroups.x * workgroups.y;
    let runs_of_group = (dot_frame.dot_runs + groups - 1u) / groups;
    let first_run = frame_invocation(workgroup, workgroups, 0u, runs_of_group);
    let run = first_run + invocation_index;
    var own = vec3u(0u);
    if invocation_index < runs_of_group && run < dot_frame.dot_runs { own = cull_run(run); }
    sums[invocation_index] = own.x;
    firsts[invocation_index] = own.yz;
    // Inclusive prefix sums over the invocations (Hillis and Steele 1986).
    for (var step = 1u; step < CULL_GROUP; step *= 2u) {
        workgroupBarrier();
        var before = 0u;
        if invocation_index >= step { before = sums[invocation_index - step]; }
        workgroupBarrier();
        sums[invocation_index] += before;
    }
    let candidates = workgroupUniformLoad(&sums[CULL_GROUP - 1u]);
    for (var done = 0u; done < candidates; done += CULL_GROUP) {
        if invocation_index == 0u { atomicStore(&listed, 0u); }
        workgroupBarrier();
        let candidate = done + invocation_index;
        var entry = vec2u(0u);
        var slot = 0u;
        var may_show = false;
        if candidate < candidates {
            let at = cull_run_of(candidate);
            var before = 0u;
            if at > 0u { before = sums[at - 1u]; }
            entry = vec2u(first_run + at, firsts[at].x + ((candidate - before) << firsts[at].y));
            let clip = dots_clip(entry.x, entry.y);
            let error = dots_error(entry.x);
            let halved = cull_halved(clip.w - error.w);
            let number = dot_runs[entry.x].first + entry.y;
            may_show = !cull_is_outside(clip, clip, error) && firstTrailingBit(number) >= (halved >> DOTS_STEPS);
            if may_show { slot = atomicAdd(&listed, 1u); }
        }
        workgroupBarrier();
        if invocation_index == 0u { base = atomicAdd(&dot_count, atomicLoad(&listed)); }
        let first_slot = workgroupUniformLoad(&base);
        if may_show { dot_list[first_slot + slot] = entry; }
    }
}
