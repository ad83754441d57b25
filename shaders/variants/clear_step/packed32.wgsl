// Clear step, packed32: the word of every pixel, and the sums of its layers behind it.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> packed: array<u32>;

// Words of each pixel's sums.
override CLEARED_SUMS: u32 = 0u;

fn clear_step_packed32(index: u32, count: u32) {
    for (var i = index; i < frame.size.x * frame.size.y * (1u + CLEARED_SUMS); i += count) { packed[i] = 0u; }
}
