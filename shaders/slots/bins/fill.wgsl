// Bins, fill: writes what was counted to its place. What does not fit is left out; the count knows of it.

@group(0) @binding(6) var<storage, read_write> bins: array<atomic<u32>>;

fn bins_add(tile: u32, entry: u32) {
    let slot = atomicAdd(&bins[tile], 1u);
    if slot < frame.bin_capacity { atomicStore(&bins[tiles_lists() + slot], entry); }
}
