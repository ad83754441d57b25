// Framebuffer, packed64: key and complemented id in one 64-bit maximum; the nearest wins, then the smallest id.

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u64>>;

// Load before the atomic: faster where many samples lose.
override EARLY_LOAD: bool = false;

fn framebuffer_begin(id: u32) -> bool { return true; }

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    let word = (u64(key) << 32u) | u64(~id);
    let is_behind = EARLY_LOAD && atomicLoad(&depth_and_id[pixel]) >= word;
    if !is_behind { atomicMax(&depth_and_id[pixel], word); }
}
