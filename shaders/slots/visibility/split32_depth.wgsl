// Visibility split32, first half: the nearest depth key of every pixel. Portable.

@group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;

// Look before the atomic: pays where many samples lose.
override EARLY_LOAD: bool = false;

fn visibility_begin(id: u32) {}

fn visibility_write(pixel: u32, key: u32, id: u32) {
    let is_hopeless = EARLY_LOAD && atomicLoad(&depth_keys[pixel]) >= key;
    if !is_hopeless { atomicMax(&depth_keys[pixel], key); }
}
