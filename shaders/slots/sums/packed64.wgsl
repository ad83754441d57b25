// Sums of packed64: the words of each pixel behind the words of depth and triangle id, which are read as their halves.
//@ use common/frame

// Words per pixel.
override SUM_WORDS: u32 = 4u;

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u32>>;

// Key of the pixel's front.
fn sums_front(pixel: u32) -> u32 {
    return atomicLoad(&depth_and_id[2u * pixel + 1u]);
}

// Adds to word `lane` of a pixel and returns what it was.
fn sums_add(pixel: u32, lane: u32, value: u32) -> u32 {
    return atomicAdd(&depth_and_id[2u * frame.size.x * frame.size.y + SUM_WORDS * pixel + lane], value);
}
