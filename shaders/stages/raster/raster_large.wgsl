// raster_large: one workgroup per tile of 64x64 pixels of a large triangle, in sixteen blocks of 16x16 pixels.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/shape
//@ use lib/queues
//@ use lib/queued_triangle
//@ use variants/large_edges
//@ use variants/large_depth
//@ use variants/depth
//@ use variants/framebuffer_write
//@ use steps/sample_test

// Three edges of sixteen blocks.
var<workgroup> blocks: array<BlockEdge, 48>;

@compute @workgroup_size(64)
fn raster_large(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let slot = queues_tiles_done() + workgroup.y * workgroups.x + workgroup.x;
    let exists = slot < queues_tiles_count();
    let word = frame.tile_first + 2u * select(0u, slot, exists);
    let packed_tile = queues[word + 1u];
    let t = queued_triangle(queues[word]);
    let large = clockwise_triangle(t);

    let tile = vec2i(vec2u(packed_tile & 0xffffu, packed_tile >> 16u)) * 64;
    if invocation_index < 48u {
        let block = i32(invocation_index / 3u);
        let p = grid_sample(tile + vec2i(block % 4, block / 4) * 16);
        let edge = invocation_index % 3u;
        let begin = select(select(large.a, large.c, edge == 1u), large.b, edge == 0u);
        let end = select(select(large.b, large.a, edge == 1u), large.c, edge == 0u);
        blocks[invocation_index] = block_edge(begin, end, p, large.bias[edge]);
        large_depth_prepare(invocation_index, begin, end, p);
    }
    workgroupBarrier();
    if !exists { return; }

    framebuffer_begin(t.id);
    let pixels = clockwise_pixels(large);
    let plane = depth_plane_wide(large.z, large.area);
    let nearest = depth_key(bitcast<f32>(max(max(large.z.x, large.z.y), large.z.z)));
    let mine = vec2i(vec2u(invocation_index % 16u, invocation_index / 16u));
    for (var block = 0; block < 16; block += 1) {
        let origin = tile + vec2i(block % 4, block / 4) * 16;
        let e0 = blocks[block * 3];
        let e1 = blocks[block * 3 + 1];
        let e2 = blocks[block * 3 + 2];
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
}
