// Order, racy: load, test, add, as a beginner's kernel counts. Between the load and the add others pass, so it overshoots by
// the samples in flight.
//@ use common/order
//@ use common/counters

@group(0) @binding(14) var<uniform> order: Order;

// Several passes visit the samples of a frame: each counts by itself.
override USES_SECOND_COUNTER: bool = false;

fn order_is_drawn(t: Triangle, pixel: u32) -> bool {
    if USES_SECOND_COUNTER {
        if order.limit_hi == 0u && atomicLoad(&counters.next_sample_index_again) >= order.limit_lo { return false; }
        atomicAdd(&counters.next_sample_index_again, 1u);
        return true;
    }
    if order.limit_hi == 0u && atomicLoad(&counters.next_sample_index) >= order.limit_lo { return false; }
    atomicAdd(&counters.next_sample_index, 1u);
    return true;
}
