// raster_medium: draws queued triangles of at most 128 px extent. The 64 invocations of a workgroup are a block of 8x8 pixels that moves
// over a triangle's box.
//@ use variants/medium_boxes
// Finds the tiles of large triangles beside its own work, since neither needs the other. Chosen where the number of workgroups is fixed, in
// the first pass over the medium queue; without it, tile_large is a pass of its own.
//@ steps fn divide_step(group: u32, groups: u32, invocation_index: u32)

@compute @workgroup_size(64)
fn raster_medium(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let group = workgroup.y * workgroups.x + workgroup.x;
    let groups = workgroups.x * workgroups.y;
    divide_step(group, groups, invocation_index);
    medium_boxes(group, groups, invocation_index);
}

//@ step large_queue
//@ use lib/large_queue

fn divide_step_large_queue(group: u32, groups: u32, invocation_index: u32) {
    large_queue_divide(group, groups, invocation_index);
}
