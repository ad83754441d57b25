// X-ray buffer, packed64: behind the 64-bit words, which are read as halves.
//@ use lib/frame

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u32>>;

fn xray_buffer_front(pixel: u32) -> u32 {
    return atomicLoad(&depth_and_id[2u * pixel + 1u]);
}

fn xray_buffer_add(word: u32, value: u32) -> u32 {
    return atomicAdd(&depth_and_id[2u * frame.size.x * frame.size.y + word], value);
}
