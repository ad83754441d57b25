// Large tiles: how the workgroups of raster_large draw the queued tiles.
// Chosen by how work is shared: shared where workgroups take several tiles each, or where hidden blocks are left out. Default: the
// function below, with a workgroup for every tile. CPU adapters take it: they compile barriers inside loops very slowly.
//@ use lib/frame
//@ use lib/shape
//@ use lib/queues
//@ use lib/queued_triangle
//@ use lib/large_tile
//@ use variants/large_edges
//@ use variants/large_depth
//@ use variants/depth
//@ use variants/framebuffer_write
//@ use steps/sample_test

// `group` of `groups` workgroups.
//@ declare fn large_tiles(group: u32, groups: u32, invocation_index: u32)
fn large_tiles(group: u32, groups: u32, invocation_index: u32) {
    let slot = queues_tiles_done() + group;
    let exists = slot < queues_tiles_count();
    let word = frame.tile_first + 2u * select(0u, slot, exists);
    let packed_tile = queues[word + 1u];
    let t = queued_triangle(queues[word]);
    let large = clockwise_triangle(t);

    let tile = vec2i(vec2u(packed_tile & 0xffffu, packed_tile >> 16u)) * 64;
    large_tile_prepare(large, tile, invocation_index);
    workgroupBarrier();
    if !exists { return; }

    if !framebuffer_begin(t.id) { return; }
    let pixels = clockwise_pixels(large);
    let plane = depth_plane_wide(large.z, large.area);
    let nearest = depth_key(bitcast<f32>(max(max(large.z.x, large.z.y), large.z.z)));
    let mine = vec2i(vec2u(invocation_index % 16u, invocation_index / 16u));
    for (var block = 0; block < 16; block += 1) {
        let origin = tile + vec2i(block % 4, block / 4) * 16;
        let e0 = tile_edges[block * 3];
        let e1 = tile_edges[block * 3 + 1];
        let e2 = tile_edges[block * 3 + 2];
        // An edge function is largest 15 pixels along its own inward direction.
        if SHAPE != SHAPE_BOXES && !block_contains(e0, e1, e2, 15 * (max(large.dx, vec3i(0)) + max(-large.dy, vec3i(0)))) { continue; }
        for (var i = 0; i < 4; i += 1) {
            let offset = mine + vec2i(0, 4 * i);
            let at = origin + offset;
            let step = large.dx * offset.y - large.dy * offset.x;
            let is_covered = (SHAPE == SHAPE_BOXES || block_contains(e0, e1, e2, step)) && all(at >= pixels.xy) && all(at <= pixels.zw);
            if is_covered && sample_test(t, vec2u(at), u32(at.y) * frame.size.x + u32(at.x)) {
                var key = nearest;
                if SHAPE != SHAPE_BOXES {
                    key = block_depth_key(block_depth_prepared(plane, u32(block) * 3u), e0, e1, e2, step, large.bias);
                }
                framebuffer_write(u32(at.y) * frame.size.x + u32(at.x), key, t.id);
            }
        }
    }
    framebuffer_end(t.id);
}
