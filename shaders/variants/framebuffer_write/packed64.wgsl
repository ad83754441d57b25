// Framebuffer, packed64: key and complemented id in one 64-bit maximum; the nearest wins, then the smallest id.

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<atomic<u64>>;

fn framebuffer_begin(id: u32) -> bool { return true; }

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    atomicMax(&depth_and_id[pixel], (u64(key) << 32u) | u64(~id));
}
