// Framebuffer, boundary samples: one bit per pixel, for the samples of the triangle in which drawing stops.

@group(0) @binding(5) var<storage, read_write> boundary_samples: array<atomic<u32>>;

fn framebuffer_begin(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    atomicOr(&boundary_samples[pixel / 32u], 1u << (pixel % 32u));
}
