// Clear step, split32: key and id of every pixel, in two buffers, and the sums of its layers behind the keys.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> triangle_ids: array<u32>;

// Words of each pixel's sums.
override CLEARED_SUMS: u32 = 0u;

fn clear_step_split32(index: u32, count: u32) {
    for (var i = index; i < frame.size.x * frame.size.y; i += count) { triangle_ids[i] = 0u; }
    for (var i = index; i < frame.size.x * frame.size.y * (1u + CLEARED_SUMS); i += count) { depth_keys[i] = 0u; }
}
