// order_cut: at which pixel drawing stops within the boundary triangle, the triangle in which the limit is reached.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/order

@group(0) @binding(5) var<storage, read> boundary_samples: array<u32>;
@group(0) @binding(14) var<storage, read_write> order: Order;

var<workgroup> before: array<u32, 256>;

@compute @workgroup_size(256)
fn order_cut(@builtin(local_invocation_index) invocation_index: u32) {
    let words = (frame.size.x * frame.size.y + 31u) / 32u;
    let words_each = (words + 255u) / 256u;
    let first = min(invocation_index * words_each, words);
    let last = min(first + words_each, words);
    var sum = 0u;
    for (var i = first; i < last; i += 1u) { sum += countOneBits(boundary_samples[i]); }
    before[invocation_index] = sum;
    workgroupBarrier();
    if invocation_index == 0u {
        sum = 0u;
        for (var i = 0u; i < 256u; i += 1u) {
            let here = before[i];
            before[i] = sum;
            sum += here;
        }
        // There is no boundary triangle: everything is drawn, or there is nothing to draw.
        if order.boundary_triangle == frame.triangle_count {
            order.cut = 0u;
            order.drawn_hi = order.before_hi;
            order.drawn_lo = order.before_lo;
        }
    }
    workgroupBarrier();
    let rest = order.limit_lo - order.before_lo;
    sum = before[invocation_index];
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
