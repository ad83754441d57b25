// Reject: counts triangles with a corner that is no number or out of range.
//@ use common/vertex
//@ use common/counters

// Was it rejected? `any_flag` gathers the flags of all corners.
fn reject_count(any_flag: u32) -> bool {
    if (any_flag & VERTEX_NONFINITE) != 0u {
        atomicAdd(&counters.rejected_nonfinite, 1u);
    } else if (any_flag & VERTEX_OUT_OF_RANGE) != 0u {
        atomicAdd(&counters.rejected_range, 1u);
    }
    return (any_flag & VERTEX_REJECTED) != 0u;
}
