// Prefix sums of 64-bit numbers over the 256 invocations of a workgroup (Hillis and Steele 1986).
//@ use lib/fixed

var<workgroup> order_sums_to: array<Wide, 256>;

// Sum of the values of all earlier invocations. Every invocation of the workgroup calls it.
fn order_scan(invocation_index: u32, value: Wide) -> Wide {
    // Every invocation has read the sums of a scan before.
    workgroupBarrier();
    order_sums_to[invocation_index] = value;
    workgroupBarrier();
    for (var step = 1u; step < 256u; step *= 2u) {
        var other = Wide(0u, 0u);
        if invocation_index >= step { other = order_sums_to[invocation_index - step]; }
        workgroupBarrier();
        order_sums_to[invocation_index] = fixed_add(order_sums_to[invocation_index], other);
        workgroupBarrier();
    }
    return fixed_sub(order_sums_to[invocation_index], value);
}

// Sum of all values of the scan before.
fn order_scan_total() -> Wide {
    return order_sums_to[255];
}
