// Order, free: every sample is drawn, in whatever order.

fn order_is_drawn(t: Triangle, pixel: u32) -> bool {
    return true;
}
