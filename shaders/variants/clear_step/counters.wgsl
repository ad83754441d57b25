// Clear step, counters: demand of queues, what was not drawn, and the keys of hidden blocks.
//@ use lib/frame

fn clear_step_counters(index: u32, count: u32) {
    for (var i = index; i < arrayLength(&counters.farthest); i += count) { atomicStore(&counters.farthest[i], 0u); }
    if index != 0u { return; }
    atomicStore(&counters.clip, 0u);
    atomicStore(&counters.medium, 0u);
    atomicStore(&counters.large, 0u);
    atomicStore(&counters.tiles, 0u);
    atomicStore(&counters.clipped_triangles, 0u);
    atomicStore(&counters.rejected_nonfinite, 0u);
    atomicStore(&counters.rejected_range, 0u);
    atomicStore(&counters.degenerate, 0u);
    atomicStore(&counters.flipped_clips, 0u);
    atomicStore(&counters.depth_without_id, 0u);
    atomicStore(&counters.marked_tiles, 0u);
    atomicStore(&counters.next_sample_index, 0u);
    atomicStore(&counters.next_sample_index_again, 0u);
    atomicStore(&counters.full_pixels, 0u);
    atomicStore(&counters.dropped, 0u);
    atomicStore(&counters.visible_meshlets, 0u);
    atomicStore(&counters.outside, 0u);
    atomicStore(&counters.backfacing, 0u);
    atomicStore(&counters.hidden, 0u);
    atomicStore(&counters.visible_meshlets_done, 0u);
    atomicStore(&counters.clip_done, 0u);
    atomicStore(&counters.medium_done, 0u);
    atomicStore(&counters.large_done, 0u);
    atomicStore(&counters.tiles_done, 0u);
    atomicStore(&counters.listed_dots, 0u);
    atomicStore(&counters.background_tiles, 0u);
    atomicStore(&counters.spare_0, 0u);
    atomicStore(&counters.spare_1, 0u);
}
