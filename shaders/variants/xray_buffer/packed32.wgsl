// X-ray buffer, packed32: behind the packed words, which keep only a part of the front's key.
//@ use lib/frame
//@ use lib/packed32

@group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

fn xray_buffer_front(pixel: u32) -> u32 {
    return packed32_unpacked(atomicLoad(&packed[pixel])).y;
}

fn xray_buffer_add(word: u32, value: u32) -> u32 {
    return atomicAdd(&packed[frame.size.x * frame.size.y + word], value);
}
