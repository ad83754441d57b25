// Order, straddler: only the triangle in which the drawing stops.
//@ use common/order

@group(0) @binding(14) var<uniform> order: Order;

fn order_is_drawn(t: Triangle, pixel: u32) -> bool {
    return t.id == order.straddler;
}
