// project: pulls every vertex, transforms it, classifies it against the near plane and the guard band, snaps it and stores 16
// bytes. Where triangles share no vertices, that is every corner of every triangle. It may clear what the frame begins with, too.
//@ use lib/frame
//@ use variants/projection
//@ use variants/vertex_records
//@ use steps/clear_step

// There may be many more invocations than vertices, for what is cleared.
override HAS_SURPLUS: bool = false;

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(GROUP_SIZE)
fn project(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    clear_step(frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE), workgroups.x * workgroups.y * GROUP_SIZE);
    // No other early return: what all invocations load alike is then loaded once, even where branches are masks.
    let invocation = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    if HAS_SURPLUS && invocation >= frame.vertex_count { return; }
    let id = min(invocation, frame.vertex_count - 1u);
    let source = vertex_source(id);
    let record = projection_record(source.draw, source.vertex, source.triangle);
    if invocation < frame.vertex_count { vertices[id] = record; }
}
