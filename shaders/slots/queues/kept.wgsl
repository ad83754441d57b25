// Queues: triangle ids (or pieces) waiting for a kernel of their size. The counter keeps the true demand; only what
// fits is stored, so a full queue shows as demand > capacity and the frame is drawn again with a larger one.
//@ use common/frame
//@ use common/counters

@group(0) @binding(8) var<storage, read_write> queues: array<u32>;

fn queues_push_clip(entry: u32) {
    let slot = atomicAdd(&counters.clip, 1u);
    if slot < frame.clip_capacity { queues[slot] = entry; }
}

fn queues_push_medium(entry: u32) {
    let slot = atomicAdd(&counters.medium, 1u);
    if slot < frame.medium_capacity { queues[frame.medium_first + slot] = entry; }
}

fn queues_push_large(entry: u32) {
    let slot = atomicAdd(&counters.large, 1u);
    if slot < frame.large_capacity { queues[frame.large_first + slot] = entry; }
}

fn queues_push_tile(entry: u32, tile: vec2u) {
    let slot = atomicAdd(&counters.tiles, 1u);
    if slot < frame.tile_capacity {
        queues[frame.tile_first + 2u * slot] = entry;
        queues[frame.tile_first + 2u * slot + 1u] = tile.x | (tile.y << 16u);
    }
}
