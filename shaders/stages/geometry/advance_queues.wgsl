// advance_queues: ends the early culling phase, so that the next passes continue behind its entries; or reopens all entries of
// both phases for a pass that visits them together.
//@ use lib/frame
//@ use lib/queues

// Both phases are over.
override REOPENS_QUEUES: bool = false;

fn done(count: u32) -> u32 {
    return select(count, 0u, REOPENS_QUEUES);
}

@compute @workgroup_size(1)
fn advance_queues() {
    atomicStore(&counters.visible_meshlets_done, done(atomicLoad(&counters.visible_meshlets)));
    atomicStore(&counters.clip_done, done(queues_clip_count()));
    atomicStore(&counters.medium_done, done(queues_medium_count()));
    atomicStore(&counters.large_done, done(queues_large_count()));
    atomicStore(&counters.tiles_done, done(queues_tiles_count()));
}
