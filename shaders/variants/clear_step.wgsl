// Clear steps: what a frame begins with is cleared by its first pass, beside the work of that pass: the counters, and the depths,
// triangle ids and sums of all pixels, and what a draw order counts. Each of `count` invocations clears a share.
// Chosen where that is faster than clearing whole buffers before the first pass; without it, those are cleared so.
//@ steps fn clear_step(index: u32, count: u32)

//@ step counters
// Demand of queues, what was not drawn, and the keys of hidden blocks.
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

//@ step split32
// Key and id of every pixel, in two buffers, and the sums of its layers behind the keys.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> triangle_ids: array<u32>;

// Words of each pixel's sums.
override CLEARED_SUMS: u32 = 0u;

fn clear_step_split32(index: u32, count: u32) {
    for (var i = index; i < frame.size.x * frame.size.y; i += count) { triangle_ids[i] = 0u; }
    for (var i = index; i < frame.size.x * frame.size.y * (1u + CLEARED_SUMS); i += count) { depth_keys[i] = 0u; }
}

//@ step depth
// The key of every texel of a shadow map.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_keys: array<u32>;

fn clear_step_depth(index: u32, count: u32) {
    for (var i = index; i < frame.size.x * frame.size.y; i += count) { depth_keys[i] = 0u; }
}

//@ step packed32
// The word of every pixel, and the sums of its layers behind it.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> packed: array<u32>;

// Words of each pixel's sums.
override CLEARED_SUMS: u32 = 0u;

fn clear_step_packed32(index: u32, count: u32) {
    for (var i = index; i < frame.size.x * frame.size.y * (1u + CLEARED_SUMS); i += count) { packed[i] = 0u; }
}

//@ step packed64
// Key and id of every pixel, and the sums of its layers behind them.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<vec2u>;

// Words of each pixel's sums.
override CLEARED_SUMS: u32 = 0u;

fn clear_step_packed64(index: u32, count: u32) {
    for (var i = index; i < (frame.size.x * frame.size.y * (2u + CLEARED_SUMS) + 1u) / 2u; i += count) { depth_and_id[i] = vec2u(0u); }
}

//@ step sample_counts
// The number of samples of every triangle, in a draw order.
//@ use lib/frame

@group(0) @binding(21) var<storage, read_write> sample_counts: array<u32>;

fn clear_step_sample_counts(index: u32, count: u32) {
    for (var i = index; i < frame.triangle_count; i += count) { sample_counts[i] = 0u; }
}

//@ step boundary_samples
// The bits that mark samples of the boundary triangle, and the two words that bound them.
//@ use lib/frame
//@ use lib/order

@group(0) @binding(22) var<storage, read_write> boundary_samples: array<u32>;

fn clear_step_boundary_samples(index: u32, count: u32) {
    for (var i = index; i < order_bit_words() + 2u; i += count) { boundary_samples[i] = 0u; }
}
