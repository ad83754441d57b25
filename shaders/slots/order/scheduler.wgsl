// Order, scheduler: every covered sample draws a ticket, and the first are drawn: their number is exact, which they are
// is the hardware's own affair and differs from frame to frame.
//@ use common/order
//@ use common/counters

@group(0) @binding(14) var<uniform> order: Order;

// Several passes visit the samples of a frame: each has its own tickets.
override USES_SECOND_COUNTER: bool = false;

fn order_is_drawn(t: Triangle, pixel: u32) -> bool {
    var ticket = 0u;
    if USES_SECOND_COUNTER { ticket = atomicAdd(&counters.next_sample_index_again, 1u); }
    else { ticket = atomicAdd(&counters.next_sample_index, 1u); }
    return order.limit_hi > 0u || ticket < order.limit_lo;
}
