// Bins, count: how long the list of each tile will be.

@group(0) @binding(6) var<storage, read_write> bins: array<atomic<u32>>;

fn bins_add(tile: u32, entry: u32) {
    atomicAdd(&bins[tile], 1u);
}
