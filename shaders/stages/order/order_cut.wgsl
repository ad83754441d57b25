// order_cut: at which pixel drawing stops within the boundary triangle, the triangle in which the limit is reached.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/order
//@ use lib/order_scan

@group(0) @binding(5) var<storage, read> boundary_samples: array<u32>;
@group(0) @binding(14) var<storage, read_write> order: Order;

@compute @workgroup_size(256)
fn order_cut(@builtin(local_invocation_index) invocation_index: u32) {
    // The words that have bits; without a boundary triangle none has.
    let begin = ~boundary_samples[order_bit_words()];
    let end = boundary_samples[order_bit_words() + 1u];
    let words_each = (max(end, begin) - begin + 255u) / 256u;
    let first = min(begin + invocation_index * words_each, end);
    let last = min(first + words_each, end);
    var sum = 0u;
    for (var i = first; i < last; i += 1u) { sum += countOneBits(boundary_samples[i]); }
    // There is no boundary triangle: everything is drawn, or there is nothing to draw.
    if invocation_index == 0u && order.boundary_triangle == frame.triangle_count {
        order.cut = 0u;
        order.drawn_hi = order.before_hi;
        order.drawn_lo = order.before_lo;
    }
    let rest = order.limit_lo - order.before_lo;
    sum = order_scan(invocation_index, Wide(0u, sum)).lo;
    for (var i = first; i < last; i += 1u) {
        let here = countOneBits(boundary_samples[i]);
        if sum <= rest && rest < sum + here {
            var bits = boundary_samples[i];
            for (var skip = sum; skip < rest; skip += 1u) { bits &= bits - 1u; }
            order.cut = i * 32u + countTrailingZeros(bits);
            let drawn = fixed_add(Wide(order.before_hi, order.before_lo), Wide(0u, rest));
            order.drawn_hi = drawn.hi;
            order.drawn_lo = drawn.lo;
        }
        sum += here;
    }
}
