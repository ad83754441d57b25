// tile_large: one workgroup per large triangle finds the tiles of 64x64 pixels that the triangle may touch.
//@ use lib/large_queue

@compute @workgroup_size(64)
fn tile_large(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    large_queue_divide(workgroup.y * workgroups.x + workgroup.x, workgroups.x * workgroups.y, invocation_index);
}
