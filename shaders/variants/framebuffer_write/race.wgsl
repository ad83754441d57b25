// Framebuffer, race: load, compare, store, without atomics. The last store wins, not the nearest sample.
//@ use steps/store_step

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<u32>;

fn framebuffer_begin(id: u32) -> bool { return true; }

fn framebuffer_end(id: u32) {}

fn framebuffer_write(pixel: u32, key: u32, id: u32) {
    let is_nearer = depth_and_id[2u * pixel + 1u] < key;
    if is_nearer && store_step(key) {
        depth_and_id[2u * pixel + 1u] = key;
        depth_and_id[2u * pixel] = ~id;
    }
}
