// Rounds: ends the first round, so that the next passes take up what comes behind its entries, or opens all entries of both
// again, for a pass that visits them together.
//@ use common/frame
//@ use common/counters

// Both rounds are over.
override REOPENS_QUEUES: bool = false;

fn rounds_done(count: u32, capacity: u32) -> u32 {
    return select(min(count, capacity), 0u, REOPENS_QUEUES);
}

@compute @workgroup_size(1)
fn rounds() {
    atomicStore(&counters.visible_meshlets_done, rounds_done(atomicLoad(&counters.visible_meshlets), 0xffffffffu));
    atomicStore(&counters.clip_done, rounds_done(atomicLoad(&counters.clip), frame.clip_capacity));
    atomicStore(&counters.medium_done, rounds_done(atomicLoad(&counters.medium), frame.medium_capacity));
    atomicStore(&counters.large_done, rounds_done(atomicLoad(&counters.large), frame.large_capacity));
    atomicStore(&counters.tiles_done, rounds_done(atomicLoad(&counters.tiles), frame.tile_capacity));
}
