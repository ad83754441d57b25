// Order, submission: the first samples of the triangles in order, each triangle's row by row; the same set everywhere.
//@ use common/order

@group(0) @binding(14) var<uniform> order: Order;

fn order_is_drawn(t: Triangle, pixel: u32) -> bool {
    return t.id < order.straddler || (t.id == order.straddler && pixel < order.cut);
}
