// Visibility split32, second half: of the triangles that reach the nearest key, the smallest id owns the pixel.

@group(0) @binding(5) var<storage, read> depth_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> triangle_ids: array<atomic<u32>>;

fn visibility_begin(id: u32) {}

fn visibility_write(pixel: u32, key: u32, id: u32) {
    if depth_keys[pixel] == key {
        atomicMax(&triangle_ids[pixel], ~id);
    }
}
