// Dots ends: both ends of every segment in clip space, once. All ways of choosing dots start from these bits.
//@ use common/frame
//@ use common/dot_frame
//@ use slot/dot_ends

@group(0) @binding(22) var<storage, read_write> dot_ends: array<vec4f>;

@compute @workgroup_size(64)
fn dots_ends(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let id = frame_invocation(group, groups, lane, 64u);
    if id >= dot_frame.segments { return; }
    let ends = dot_ends_of(id);
    // A line that goes nowhere goes behind the eye.
    let nowhere = vec4f(0.0, 0.0, 0.0, -1.0);
    dot_ends[2u * id] = select(nowhere, ends.begin, ends.is_sound);
    dot_ends[2u * id + 1u] = select(nowhere, ends.end, ends.is_sound);
}
