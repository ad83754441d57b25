// dots_ends: both ends of every segment in clip space, once. Every way of choosing dots starts from these bits.
//@ use lib/frame
//@ use lib/dots
//@ use variants/dot_segments

@group(0) @binding(22) var<storage, read_write> dot_ends: array<vec4f>;

@compute @workgroup_size(64)
fn dots_ends(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let id = frame_invocation(workgroup, workgroups, invocation_index, 64u);
    if id >= dot_frame.segments { return; }
    let ends = dot_segment(id);
    // A segment without valid ends is moved behind the eye.
    let behind = vec4f(0.0, 0.0, 0.0, -1.0);
    dot_ends[2u * id] = select(behind, ends.begin, ends.is_valid);
    dot_ends[2u * id + 1u] = select(behind, ends.end, ends.is_valid);
}
