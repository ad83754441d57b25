// Clear step, boundary samples: the bits that mark samples of the boundary triangle, and the two words that bound them.
//@ use lib/frame
//@ use lib/order

@group(0) @binding(22) var<storage, read_write> boundary_samples: array<u32>;

fn clear_step_boundary_samples(index: u32, count: u32) {
    for (var i = index; i < order_bit_words() + 2u; i += count) { boundary_samples[i] = 0u; }
}
