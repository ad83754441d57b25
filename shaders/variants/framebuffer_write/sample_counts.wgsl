// Framebuffer, sample counts: samples per triangle, exactly, before any depth test. Each invocation counts for itself and adds once.

@group(0) @binding(5) var<storage, read_write> sample_counts: array<atomic<u32>>;

var<private> found_samples: u32;

fn framebuffer_begin(id: u32) -> bool {
    found_samples = 0u;
    return true;
}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    found_samples += 1u;
}

fn framebuffer_end(id: u32) {
    if found_samples > 0u { atomicAdd(&sample_counts[id], found_samples); }
}
