// raster_points: the corners of every triangle that is shown, as discs. One invocation per triangle, or several where a driver
// aborts long loops. A triangle that would have to be clipped shows no discs.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/shape
//@ use variants/discs

// This is the first of several passes over the triangles: it counts.
override IS_FIRST_VISIT: bool = true;

@compute @workgroup_size(GROUP_SIZE)
fn raster_points(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let invocation = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    let id = invocation / INVOCATIONS_PER_TRIANGLE;
    let part = invocation % INVOCATIONS_PER_TRIANGLE;
    if id >= frame.triangle_count { return; }
    let t = triangle_load(id);
    let any_flag = (t.a.x | t.b.x | t.c.x) & 255u;
    if any_flag != 0u {
        if IS_FIRST_VISIT && part == 0u { triangle_rejected(any_flag); }
        return;
    }
    let orientation = fixed_sign(fixed_edge(vertex_at(t.a), vertex_at(t.b), vertex_at(t.c)));
    if orientation == 0 {
        if IS_FIRST_VISIT && part == 0u { atomicAdd(&counters.degenerate, 1u); }
        return;
    }
    if !triangle_is_shown(draws[t.draw].flags, orientation > 0) { return; }
    discs(t, part);
}
