// Framebuffer, layers: layers per pixel before any depth test, for the heat map and for the proof that every sample is drawn
// exactly once.

@group(0) @binding(15) var<storage, read_write> layers: array<atomic<u32>>;

fn framebuffer_begin(id: u32) -> bool { return true; }

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    atomicAdd(&layers[pixel], 1u);
}
