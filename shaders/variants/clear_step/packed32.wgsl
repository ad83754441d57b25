// Clear step, packed32: the word of every pixel.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> packed: array<u32>;

fn clear_step_packed32(index: u32, count: u32) {
    for (var i = index; i < frame.size.x * frame.size.y; i += count) { packed[i] = 0u; }
}
