// Visibility race: look, compare, store, without atomics, as a beginner's kernel does it. Whoever stores last stays.
//@ use slot/delay

@group(0) @binding(5) var<storage, read_write> depth_and_id: array<u32>;

fn visibility_begin(id: u32) {}

fn visibility_write(pixel: u32, key: u32, id: u32) {
    let is_nearer = depth_and_id[2u * pixel + 1u] < key;
    if is_nearer && delay_passes(key) {
        depth_and_id[2u * pixel + 1u] = key;
        depth_and_id[2u * pixel] = ~id;
    }
}
