// Clear step, packed64: key and id of every pixel, and the sums of its layers behind them.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<vec2u>;

// Words of each pixel's sums.
override CLEARED_SUMS: u32 = 0u;

fn clear_step_packed64(index: u32, count: u32) {
    for (var i = index; i < (frame.size.x * frame.size.y * (2u + CLEARED_SUMS) + 1u) / 2u; i += count) { depth_and_id[i] = vec2u(0u); }
}
