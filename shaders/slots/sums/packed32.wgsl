// Sums of packed32: the words of each pixel behind those of depth and triangle id.
//@ use common/frame
//@ use common/packed

// Words per pixel.
override SUM_WORDS: u32 = 4u;

@group(0) @binding(5) var<storage, read_write> packed: array<atomic<u32>>;

// Key of the pixel's front, as much as is left of it.
fn sums_front(pixel: u32) -> u32 {
    return packed_parts(atomicLoad(&packed[pixel])).y;
}

// Adds to word `lane` of a pixel and returns what it was.
fn sums_add(pixel: u32, lane: u32, value: u32) -> u32 {
    return atomicAdd(&packed[frame.size.x * frame.size.y + SUM_WORDS * pixel + lane], value);
}
