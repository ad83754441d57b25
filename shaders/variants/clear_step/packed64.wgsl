// Clear step, packed64: key and id of every pixel.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<vec2u>;

fn clear_step_packed64(index: u32, count: u32) {
    for (var i = index; i < frame.size.x * frame.size.y; i += count) { depth_and_id[i] = vec2u(0u); }
}
