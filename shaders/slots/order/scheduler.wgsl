// Order, scheduler: every covered sample draws a ticket, and the first are drawn: their number is exact, which they are
// is the hardware's own affair and differs from frame to frame.
//@ use common/order
//@ use common/counters

@group(0) @binding(14) var<uniform> order: Order;

// Several passes visit the samples of a frame: each has its own tickets.
override IS_AGAIN: bool = false;

fn order_is_drawn(t: Triangle, pixel: u32) -> bool {
    var ticket = 0u;
    if IS_AGAIN { ticket = atomicAdd(&counters.tickets_again, 1u); }
    else { ticket = atomicAdd(&counters.tickets, 1u); }
    return order.limit_hi > 0u || ticket < order.limit_lo;
}
