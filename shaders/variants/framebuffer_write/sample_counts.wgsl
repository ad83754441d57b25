// Framebuffer, sample counts: samples per triangle, exactly, before any depth test.

@group(0) @binding(5) var<storage, read_write> sample_counts: array<atomic<u32>>;

fn framebuffer_begin(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    atomicAdd(&sample_counts[id], 1u);
}
