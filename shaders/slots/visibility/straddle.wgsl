// Visibility straddle: one bit for each sample of the triangle in which the drawing stops.

@group(0) @binding(5) var<storage, read_write> boundary_samples: array<atomic<u32>>;

fn visibility_begin(id: u32) {}

fn visibility_write(pixel: u32, key: u32, id: u32) {
    atomicOr(&boundary_samples[pixel / 32u], 1u << (pixel % 32u));
}
