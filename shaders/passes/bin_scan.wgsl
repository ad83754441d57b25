// Bin scan: turns the lengths of the tiles' lists into the places where they begin, and keeps the length of them all and of the longest.
//@ use common/tiles
//@ use common/counters

@group(0) @binding(6) var<storage, read_write> bins: array<u32>;

var<workgroup> sums: array<u32, 256>;

// More than a word holds counts as all that a word holds: no buffer has so much room.
fn bin_sum(a: u32, b: u32) -> u32 {
    return select(a + b, 0xffffffffu, a + b < a);
}

@compute @workgroup_size(256)
fn bin_scan(@builtin(local_invocation_index) lane: u32) {
    let tiles = tiles_count();
    let share = (tiles + 255u) / 256u;
    let first = min(lane * share, tiles);
    let last = min(first + share, tiles);
    var sum = 0u;
    var longest = 0u;
    for (var i = first; i < last; i += 1u) {
        sum = bin_sum(sum, bins[i]);
        longest = max(longest, bins[i]);
    }
    atomicMax(&counters.longest_list, longest);
    sums[lane] = sum;
    workgroupBarrier();
    // Sums of lanes up to and with this one (Hillis and Steele 1986).
    for (var step = 1u; step < 256u; step *= 2u) {
        var other = 0u;
        if lane >= step { other = sums[lane - step]; }
        workgroupBarrier();
        sums[lane] = bin_sum(sums[lane], other);
        workgroupBarrier();
    }
    if lane == 255u { atomicStore(&counters.bins, sums[255]); }
    sum = select(0u, sums[max(lane, 1u) - 1u], lane > 0u);
    for (var i = first; i < last; i += 1u) {
        let here = bins[i];
        bins[i] = sum;
        sum = bin_sum(sum, here);
    }
}
