// Sums of split32: the words of each pixel behind the depth keys, since portable devices bind eight storage buffers to a pass
// and the medium kernel has no ninth.
//@ use common/frame

// Words per pixel.
override SUM_WORDS: u32 = 4u;

@group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;

// Key of the pixel's front.
fn sums_front(pixel: u32) -> u32 {
    return atomicLoad(&depth_keys[pixel]);
}

// Adds to word `lane` of a pixel and returns what it was.
fn sums_add(pixel: u32, lane: u32, value: u32) -> u32 {
    return atomicAdd(&depth_keys[frame.size.x * frame.size.y + SUM_WORDS * pixel + lane], value);
}
