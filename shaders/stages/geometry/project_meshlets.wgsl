// project_meshlets: as project, but only the vertices of visible meshlets. Meshlets that share a vertex write the same bits to its
// record.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/meshlets
//@ use variants/projection

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(GROUP_SIZE)
fn project_meshlets(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let invocation = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    let slot = visible_meshlets_slot(invocation);
    if slot >= visible_meshlets_end() { return; }
    let meshlet = visible_meshlets_load(slot);
    for (var i = invocation % MESHLET_TRIANGLES; i < meshlet.vertices; i += MESHLET_TRIANGLES) {
        let vertex = meshlet_lists[meshlet.first_vertex + i];
        vertices[draws[meshlet.draw].first_vertex + vertex] = projection_record(meshlet.draw, vertex, 0u);
    }
}
