// project: pulls every vertex, transforms it, classifies it against the near plane and the guard band, snaps it and stores 16
// bytes. Where triangles share no vertices, that is every corner of every triangle.
//@ use lib/frame
//@ use variants/projection
//@ use variants/vertex_records

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(GROUP_SIZE)
fn project(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    // No early return: what all invocations load alike is then loaded once, even where branches are masks.
    let invocation = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    let id = min(invocation, frame.vertex_count - 1u);
    let source = vertex_source(id);
    let record = projection_record(source.draw, source.vertex, source.triangle);
    if invocation < frame.vertex_count { vertices[id] = record; }
}
