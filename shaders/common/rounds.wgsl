// Rounds: where what is hidden is left out, a frame is drawn in two rounds, and queues keep growing. The second round begins
// behind the entries of the first.
//@ use common/counters

override IS_TWO_PASS: bool = false;

fn rounds_clip_done() -> u32 {
    if IS_TWO_PASS { return atomicLoad(&counters.clip_done); }
    return 0u;
}

fn rounds_medium_done() -> u32 {
    if IS_TWO_PASS { return atomicLoad(&counters.medium_done); }
    return 0u;
}

fn rounds_large_done() -> u32 {
    if IS_TWO_PASS { return atomicLoad(&counters.large_done); }
    return 0u;
}

fn rounds_tiles_done() -> u32 {
    if IS_TWO_PASS { return atomicLoad(&counters.tiles_done); }
    return 0u;
}
