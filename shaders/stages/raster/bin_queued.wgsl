// bin_queued: one workgroup per medium or large triangle adds it to the lists of the tiles of 16x16 pixels that it may touch.
//@ use lib/frame
//@ use lib/queues
//@ use lib/queued_triangle
//@ use lib/tile_lists

// The queue of large triangles; else that of medium ones.
override IS_LARGE: bool = false;

@compute @workgroup_size(64)
fn bin_queued(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let count = select(queues_medium_count(), queues_large_count(), IS_LARGE);
    let groups = workgroups.x * workgroups.y;
    for (var slot = workgroup.y * workgroups.x + workgroup.x; slot < count; slot += groups) { list(slot, invocation_index); }
}

fn list(slot: u32, invocation_index: u32) {
    let entry = queues[select(frame.medium_first, frame.large_first, IS_LARGE) + slot];
    let t = clockwise_triangle(queued_triangle(entry));
    tile_lists_add_triangle(entry, t.a, t.b, t.c, clockwise_pixels(t), IS_LARGE, invocation_index, 64u);
}
