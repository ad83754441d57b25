// X-ray buffer, split32: behind the depth keys.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;

fn xray_buffer_front(pixel: u32) -> u32 {
    return atomicLoad(&depth_keys[pixel]);
}

fn xray_buffer_add(word: u32, value: u32) -> u32 {
    return atomicAdd(&depth_keys[frame.size.x * frame.size.y + word], value);
}
