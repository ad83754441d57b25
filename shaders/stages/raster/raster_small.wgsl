// raster_small: one invocation per triangle draws it if it is small, and else puts it into a queue.
//@ use lib/frame
//@ use lib/small_triangle

// Neighboring triangles that a workgroup takes at once; its next ones lie behind those of all other workgroups. Divides GROUP_SIZE.
override TRIANGLE_RUN: u32 = 64u;

@compute @workgroup_size(GROUP_SIZE)
fn raster_small(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let group = workgroup.y * workgroups.x + workgroup.x;
    let run = invocation_index / TRIANGLE_RUN * (workgroups.x * workgroups.y) + group;
    small_triangle(run * TRIANGLE_RUN + invocation_index % TRIANGLE_RUN);
}
