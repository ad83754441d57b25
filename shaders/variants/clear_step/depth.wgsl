// Clear step, depth: the key of every texel of a shadow map.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_keys: array<u32>;

fn clear_step_depth(index: u32, count: u32) {
    for (var i = index; i < frame.size.x * frame.size.y; i += count) { depth_keys[i] = 0u; }
}
