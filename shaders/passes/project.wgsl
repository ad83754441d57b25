// Project: pulls every vertex, transforms it, tells what lies before the near plane, snaps it once, and keeps 16 bytes.
// Where effects part the triangles, that is every corner of every triangle.
//@ use common/frame
//@ use slot/projection
//@ use slot/sources

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(GROUP_SIZE)
fn project(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    // No early return: what all lanes load alike is then loaded once, even where branches are lane masks.
    let invocation = frame_invocation(group, groups, lane, GROUP_SIZE);
    let id = min(invocation, frame.vertex_count - 1u);
    let source = sources_of(id);
    let record = projection_record(source.draw, source.vertex, source.triangle);
    if invocation < frame.vertex_count { vertices[id] = record; }
}
