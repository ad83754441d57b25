// raster_large: draws the tiles of 64x64 pixels that tile_large has queued.
//@ use variants/large_tiles

@compute @workgroup_size(64)
fn raster_large(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    large_tiles(workgroup.y * workgroups.x + workgroup.x, workgroups.x * workgroups.y, invocation_index);
}
