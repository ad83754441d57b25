// Order, racy: load, test, add, as a beginner's kernel counts. Between the load and the add others pass, so it overshoots by
// the samples in flight.
//@ use common/order
//@ use common/counters

@group(0) @binding(14) var<uniform> order: Order;

// Several passes visit the samples of a frame: each counts by itself.
override IS_AGAIN: bool = false;

fn order_is_drawn(t: Triangle, pixel: u32) -> bool {
    if IS_AGAIN {
        if order.limit_hi == 0u && atomicLoad(&counters.tickets_again) >= order.limit_lo { return false; }
        atomicAdd(&counters.tickets_again, 1u);
        return true;
    }
    if order.limit_hi == 0u && atomicLoad(&counters.tickets) >= order.limit_lo { return false; }
    atomicAdd(&counters.tickets, 1u);
    return true;
}
