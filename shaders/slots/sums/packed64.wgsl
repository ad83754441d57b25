// Sums of packed64: four words per pixel behind the words of depth and owner, which are read as their halves.
//@ use common/frame

@group(0) @binding(5) var<storage, read_write> depth_owner: array<atomic<u32>>;

// Key of the pixel's front.
fn sums_front(pixel: u32) -> u32 {
    return atomicLoad(&depth_owner[2u * pixel + 1u]);
}

// Adds to word `lane` of a pixel and returns what it was.
fn sums_add(pixel: u32, lane: u32, value: u32) -> u32 {
    return atomicAdd(&depth_owner[2u * frame.size.x * frame.size.y + 4u * pixel + lane], value);
}
