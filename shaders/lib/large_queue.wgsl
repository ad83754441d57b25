// The queue of large triangles: finds the tiles of 64x64 pixels that each may touch, a workgroup of 64 invocations to a triangle.
//@ use lib/frame
//@ use lib/shape
//@ use lib/queues
//@ use lib/queued_triangle
//@ use steps/mark_tiles

// `group` of `groups` workgroups, which take triangles in turn.
fn large_queue_divide(group: u32, groups: u32, invocation_index: u32) {
    let count = queues_large_count();
    for (var slot = queues_large_done() + group; slot < count; slot += groups) { find_tiles(slot, invocation_index); }
}

fn find_tiles(slot: u32, invocation_index: u32) {
    let entry = queues[frame.large_first + slot];
    let t = clockwise_triangle(queued_triangle(entry));

    let pixels = clockwise_pixels(t);
    let first = pixels.xy / 64;
    let tiles = pixels.zw / 64 - first + 1;
    for (var i = i32(invocation_index); i < tiles.x * tiles.y; i += 64) {
        let tile = first + vec2i(i % tiles.x, i / tiles.x);
        let box = vec4i(max(tile * 64, pixels.xy), min(tile * 64 + 63, pixels.zw));
        if SHAPE == SHAPE_BOXES || !(edge_excludes(t.a, t.b, box) || edge_excludes(t.b, t.c, box) || edge_excludes(t.c, t.a, box)) {
            queues_push_tile(entry, vec2u(tile));
            mark_tiles(box);
        }
    }
}
