// Queues: triangles, or clipped triangles, that wait for a pass of their size. Each counter holds the true demand; only what
// fits is stored, so a full queue shows as demand above capacity and the frame is drawn again with a larger queue. Without
// queues the plan has proved that every triangle is small and none is clipped; demand is still counted, so that a wrong proof
// is detected. With two culling phases, the late phase begins behind the entries of the early one.
//@ use lib/frame
//@ use glue/queues

override HAS_QUEUES: bool = true;
override IS_TWO_PASS: bool = false;

fn queues_push_clip(entry: u32) {
    let slot = atomicAdd(&counters.clip, 1u);
    if HAS_QUEUES && slot < frame.clip_capacity { queues[slot] = entry; }
}

fn queues_push_medium(entry: u32) {
    let slot = atomicAdd(&counters.medium, 1u);
    if HAS_QUEUES && slot < frame.medium_capacity { queues[frame.medium_first + slot] = entry; }
}

fn queues_push_large(entry: u32) {
    let slot = atomicAdd(&counters.large, 1u);
    if HAS_QUEUES && slot < frame.large_capacity { queues[frame.large_first + slot] = entry; }
}

// `tile` counts tiles of 64x64 pixels.
fn queues_push_tile(entry: u32, tile: vec2u) {
    let slot = atomicAdd(&counters.tiles, 1u);
    if HAS_QUEUES && slot < frame.tile_capacity {
        queues[frame.tile_first + 2u * slot] = entry;
        queues[frame.tile_first + 2u * slot + 1u] = tile.x | (tile.y << 16u);
    }
}

// Entries that an earlier phase has drawn.
fn queues_clip_done() -> u32 {
    if IS_TWO_PASS { return atomicLoad(&counters.clip_done); }
    return 0u;
}

fn queues_medium_done() -> u32 {
    if IS_TWO_PASS { return atomicLoad(&counters.medium_done); }
    return 0u;
}

fn queues_large_done() -> u32 {
    if IS_TWO_PASS { return atomicLoad(&counters.large_done); }
    return 0u;
}

fn queues_tiles_done() -> u32 {
    if IS_TWO_PASS { return atomicLoad(&counters.tiles_done); }
    return 0u;
}

// Entries that each queue holds.
fn queues_clip_count() -> u32 {
    return min(atomicLoad(&counters.clip), frame.clip_capacity);
}

fn queues_medium_count() -> u32 {
    return min(atomicLoad(&counters.medium), frame.medium_capacity);
}

fn queues_large_count() -> u32 {
    return min(atomicLoad(&counters.large), frame.large_capacity);
}

fn queues_tiles_count() -> u32 {
    return min(atomicLoad(&counters.tiles), frame.tile_capacity);
}
