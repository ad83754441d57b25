// order_limit: how many samples there are, how many are to be drawn, and in which triangle that number is reached. The sums of
// blocks become sums of all earlier blocks.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/order
//@ use lib/order_scan
//@ use effects/draw_order
//@ use glue/effects

@group(0) @binding(5) var<storage, read> sample_counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> sums: array<vec2u>;
@group(0) @binding(14) var<storage, read_write> order: Order;

const ORDER_NONE = 0xffffffffu;

var<workgroup> limit: Wide;
// The block in which the limit is reached, and the samples before it.
var<workgroup> found: u32;
var<workgroup> before_found: Wide;

// round(total * fraction / 2^24)
fn order_fraction(total: Wide, fraction: u32) -> Wide {
    let low = fixed_add(fixed_umul(total.lo, fraction), Wide(0u, 8388608u));
    let high = fixed_umul(total.hi, fraction);
    let shifted = Wide(low.hi >> 24u, (low.lo >> 24u) | (low.hi << 8u));
    return fixed_add(shifted, Wide((high.hi << 8u) | (high.lo >> 24u), high.lo << 8u));
}

@compute @workgroup_size(256)
fn order_limit(@builtin(local_invocation_index) invocation_index: u32) {
    let blocks = (frame.triangle_count + ORDER_BLOCK - 1u) / ORDER_BLOCK;
    let blocks_each = (blocks + 255u) / 256u;
    let first = min(invocation_index * blocks_each, blocks);
    let last = min(first + blocks_each, blocks);
    var sum = Wide(0u, 0u);
    for (var i = first; i < last; i += 1u) { sum = fixed_add(sum, Wide(sums[i].x, sums[i].y)); }
    let before = order_scan(invocation_index, sum);
    if invocation_index == 0u {
        let total = order_scan_total();
        var to_draw = Wide(0u, effects.draw_order.limit);
        if effects.draw_order.unit == DRAW_ORDER_UNIT_FRACTION { to_draw = order_fraction(total, u32(round(effects.draw_order.fraction * 16777216.0))); }
        if fixed_is_less(total, to_draw) { to_draw = total; }
        limit = to_draw;
        found = ORDER_NONE;
        order.limit_hi = to_draw.hi;
        order.limit_lo = to_draw.lo;
        order.total_hi = total.hi;
        order.total_lo = total.lo;
    }
    workgroupBarrier();
    // One block contains the first sample that is not drawn.
    sum = before;
    for (var i = first; i < last; i += 1u) {
        let next = fixed_add(sum, Wide(sums[i].x, sums[i].y));
        sums[i] = vec2u(sum.hi, sum.lo);
        if !fixed_is_less(limit, sum) && fixed_is_less(limit, next) {
            found = i;
            before_found = sum;
        }
        sum = next;
    }
    // Its value is uniform, so that what follows may hold barriers.
    let block = workgroupUniformLoad(&found);
    if block == ORDER_NONE {
        if invocation_index == 0u {
            order.boundary_triangle = frame.triangle_count;
            order.before_hi = order.total_hi;
            order.before_lo = order.total_lo;
        }
        return;
    }
    let begin = block * ORDER_BLOCK + invocation_index * 4u;
    var mine = Wide(0u, 0u);
    for (var id = begin; id < min(begin + 4u, frame.triangle_count); id += 1u) { mine = fixed_add(mine, Wide(0u, sample_counts[id])); }
    sum = fixed_add(before_found, order_scan(invocation_index, mine));
    for (var id = begin; id < min(begin + 4u, frame.triangle_count); id += 1u) {
        let next = fixed_add(sum, Wide(0u, sample_counts[id]));
        if !fixed_is_less(limit, sum) && fixed_is_less(limit, next) {
            order.boundary_triangle = id;
            order.before_hi = sum.hi;
            order.before_lo = sum.lo;
        }
        sum = next;
    }
}
