// Project meshlets: as `project`, but only the vertices of meshlets that culling left. Neighbours that share a vertex write
// the same bits to its record.
//@ use common/frame
//@ use common/survivors
//@ use slot/projection

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(GROUP_SIZE)
fn project_meshlets(
    @builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32
) {
    let invocation = frame_invocation(group, groups, lane, GROUP_SIZE);
    let slot = visible_meshlets_slot(invocation);
    if slot >= visible_meshlets_end() { return; }
    let survivor = visible_meshlets_load(slot);
    for (var i = invocation % MESHLET_TRIANGLES; i < survivor.vertices; i += MESHLET_TRIANGLES) {
        let vertex = meshlet_lists[survivor.first_vertex + i];
        vertices[draws[survivor.draw].first_vertex + vertex] = projection_record(survivor.draw, vertex, 0u);
    }
}
