// Framebuffer, split32, first pass: the nearest depth key of every pixel. Portable: 32-bit atomics only.

@group(0) @binding(5) var<storage, read_write> depth_keys: array<atomic<u32>>;

// Load before the atomic: faster where many samples lose.
override EARLY_LOAD: bool = false;

fn framebuffer_begin(id: u32) -> bool { return true; }

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    let is_behind = EARLY_LOAD && atomicLoad(&depth_keys[pixel]) >= key;
    if !is_behind { atomicMax(&depth_keys[pixel], key); }
}
