// raster_small: one invocation per triangle draws it if it is small, and else puts it into a queue.
//@ use lib/frame
//@ use lib/small_triangle

@compute @workgroup_size(GROUP_SIZE)
fn raster_small(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    small_triangle(frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE));
}
