// bin_scan: turns the lengths of the tiles' lists into the words at which they begin, and records the length of all lists together
// and of the longest.
//@ use lib/frame
//@ use lib/tiles

@group(0) @binding(6) var<storage, read_write> bins: array<u32>;

var<workgroup> sums: array<u32, 256>;

// A sum that does not fit a word saturates: no buffer has so much room.
fn saturating_add(a: u32, b: u32) -> u32 {
    return select(a + b, 0xffffffffu, a + b < a);
}

@compute @workgroup_size(256)
fn bin_scan(@builtin(local_invocation_index) invocation_index: u32) {
    let tiles = tiles_count();
    let tiles_each = (tiles + 255u) / 256u;
    let first = min(invocation_index * tiles_each, tiles);
    let last = min(first + tiles_each, tiles);
    var sum = 0u;
    var longest = 0u;
    for (var i = first; i < last; i += 1u) {
        sum = saturating_add(sum, bins[i]);
        longest = max(longest, bins[i]);
    }
    atomicMax(&counters.longest_list, longest);
    sums[invocation_index] = sum;
    workgroupBarrier();
    // Inclusive prefix sums over the invocations (Hillis and Steele 1986).
    for (var step = 1u; step < 256u; step *= 2u) {
        var other = 0u;
        if invocation_index >= step { other = sums[invocation_index - step]; }
        workgroupBarrier();
        sums[invocation_index] = saturating_add(sums[invocation_index], other);
        workgroupBarrier();
    }
    if invocation_index == 255u { atomicStore(&counters.bins, sums[255]); }
    sum = select(0u, sums[max(invocation_index, 1u) - 1u], invocation_index > 0u);
    for (var i = first; i < last; i += 1u) {
        let here = bins[i];
        bins[i] = sum;
        sum = saturating_add(sum, here);
    }
}
