// Sample test, draw order: only the samples that come first are drawn. ORDER_TEST tells in which order:
// 0, submission: the first samples of the triangles in order, each triangle's row by row; the same set on every adapter.
// 1, scheduler: every covered sample takes the next index of a counter, so the number of samples is exact, but which samples
// are drawn differs from frame to frame.
// 2, racy: load, compare, add, as a simple kernel counts. Other invocations add in between, so too many samples are drawn.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/order

@group(0) @binding(14) var<uniform> order: Order;

override ORDER_TEST: u32 = 0u;
// A second pass visits the samples of the frame, and counts for itself.
override USES_SECOND_COUNTER: bool = false;

const ORDER_TEST_SUBMISSION = 0u;
const ORDER_TEST_SCHEDULER = 1u;

fn sample_test_draw_order(t: Triangle, at: vec2u, pixel: u32) -> bool {
    if ORDER_TEST == ORDER_TEST_SUBMISSION {
        return t.id < order.boundary_triangle || (t.id == order.boundary_triangle && pixel < order.cut);
    }
    if ORDER_TEST == ORDER_TEST_SCHEDULER {
        var index = 0u;
        if USES_SECOND_COUNTER { index = atomicAdd(&counters.next_sample_index_again, 1u); }
        else { index = atomicAdd(&counters.next_sample_index, 1u); }
        return order.limit_hi > 0u || index < order.limit_lo;
    }
    // The racy test.
    if USES_SECOND_COUNTER {
        if order.limit_hi == 0u && atomicLoad(&counters.next_sample_index_again) >= order.limit_lo { return false; }
        atomicAdd(&counters.next_sample_index_again, 1u);
        return true;
    }
    if order.limit_hi == 0u && atomicLoad(&counters.next_sample_index) >= order.limit_lo { return false; }
    atomicAdd(&counters.next_sample_index, 1u);
    return true;
}
