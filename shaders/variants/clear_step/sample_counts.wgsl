// Clear step, sample counts: the number of samples of every triangle, in a draw order.
//@ use lib/frame

@group(0) @binding(21) var<storage, read_write> sample_counts: array<u32>;

fn clear_step_sample_counts(index: u32, count: u32) {
    for (var i = index; i < frame.triangle_count; i += count) { sample_counts[i] = 0u; }
}
