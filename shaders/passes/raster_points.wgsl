// Raster points: the corners of every triangle that is shown, as discs. One invocation per triangle, or several
// where a driver ends long loops; one that would have to be clipped shows none.
//@ use common/triangle
//@ use common/fixed
//@ use common/reject
//@ use slot/discs

// The first of several passes over the triangles counts.
override IS_FIRST_VISIT: bool = true;

// Invocations that share the rows of a triangle's discs.
override INVOCATIONS_PER_TRIANGLE: u32 = 1u;

@compute @workgroup_size(GROUP_SIZE)
fn raster_points(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let invocation = frame_invocation(group, groups, lane, GROUP_SIZE);
    let id = invocation / INVOCATIONS_PER_TRIANGLE;
    let share = invocation % INVOCATIONS_PER_TRIANGLE;
    if id >= frame.triangle_count { return; }
    let t = triangle_load(id);
    let any_flag = (t.a.x | t.b.x | t.c.x) & 255u;
    if any_flag != 0u {
        if IS_FIRST_VISIT && share == 0u { reject_count(any_flag); }
        return;
    }
    let facing = fixed_sign(fixed_edge(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c)));
    if facing == 0 {
        if IS_FIRST_VISIT && share == 0u { atomicAdd(&counters.degenerate, 1u); }
        return;
    }
    if !triangle_is_shown(draws[t.draw].flags, facing > 0) { return; }
    discs_draw(t, share);
}
