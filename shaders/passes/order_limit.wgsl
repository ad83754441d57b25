// Order limit: how many samples there are, how many are to be drawn, and in which triangle that number is reached. Sums
// of blocks become sums of all blocks before.
//@ use common/frame
//@ use common/fixed
//@ use common/order
//@ use glue/surface

@group(0) @binding(5) var<storage, read> sample_counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> sums: array<vec2u>;
@group(0) @binding(14) var<storage, read_write> order: Order;

const ORDER_NOBODY = 0xffffffffu;

var<workgroup> before: array<Wide, 256>;
var<workgroup> limit: Wide;
var<workgroup> found: u32;

// Turns what each lane holds into the sum of all lanes before it; returns the sum of all.
fn order_scan(lane: u32) -> Wide {
    var sum = Wide(0u, 0u);
    if lane == 0u {
        for (var i = 0u; i < 256u; i += 1u) {
            let here = before[i];
            before[i] = sum;
            sum = fixed_add(sum, here);
        }
    }
    return sum;
}

// round(total * share / 2^24)
fn order_share(total: Wide, share: u32) -> Wide {
    let low = fixed_add(fixed_umul(total.lo, share), Wide(0u, 8388608u));
    let high = fixed_umul(total.hi, share);
    let shifted = Wide(low.hi >> 24u, (low.lo >> 24u) | (low.hi << 8u));
    return fixed_add(shifted, Wide((high.hi << 8u) | (high.lo >> 24u), high.lo << 8u));
}

@compute @workgroup_size(256)
fn order_limit(@builtin(local_invocation_index) lane: u32) {
    let blocks = (frame.triangle_count + 1023u) / 1024u;
    let share = (blocks + 255u) / 256u;
    let first = min(lane * share, blocks);
    let last = min(first + share, blocks);
    var sum = Wide(0u, 0u);
    for (var i = first; i < last; i += 1u) { sum = fixed_add(sum, Wide(sums[i].x, sums[i].y)); }
    before[lane] = sum;
    workgroupBarrier();
    let total = order_scan(lane);
    if lane == 0u {
        var wanted = Wide(0u, effects.draw_order.limit);
        if effects.draw_order.unit == DRAW_ORDER_UNIT_FRACTION { wanted = order_share(total, u32(round(effects.draw_order.fraction * 16777216.0))); }
        if fixed_is_less(total, wanted) { wanted = total; }
        limit = wanted;
        found = ORDER_NOBODY;
        order.limit_hi = wanted.hi;
        order.limit_lo = wanted.lo;
        order.total_hi = total.hi;
        order.total_lo = total.lo;
    }
    workgroupBarrier();
    // One block holds the sample that is the first not to be drawn.
    sum = before[lane];
    for (var i = first; i < last; i += 1u) {
        let next = fixed_add(sum, Wide(sums[i].x, sums[i].y));
        sums[i] = vec2u(sum.hi, sum.lo);
        if !fixed_is_less(limit, sum) && fixed_is_less(limit, next) { found = i; }
        sum = next;
    }
    workgroupBarrier();
    let block = found;
    if block == ORDER_NOBODY {
        if lane == 0u {
            order.straddler = frame.triangle_count;
            order.before_hi = order.total_hi;
            order.before_lo = order.total_lo;
        }
        return;
    }
    sum = Wide(sums[block].x, sums[block].y);
    workgroupBarrier();
    let begin = block * 1024u + lane * 4u;
    var mine = Wide(0u, 0u);
    for (var id = begin; id < min(begin + 4u, frame.triangle_count); id += 1u) { mine = fixed_add(mine, Wide(0u, sample_counts[id])); }
    before[lane] = mine;
    workgroupBarrier();
    order_scan(lane);
    workgroupBarrier();
    sum = fixed_add(sum, before[lane]);
    for (var id = begin; id < min(begin + 4u, frame.triangle_count); id += 1u) {
        let next = fixed_add(sum, Wide(0u, sample_counts[id]));
        if !fixed_is_less(limit, sum) && fixed_is_less(limit, next) {
            order.straddler = id;
            order.before_hi = sum.hi;
            order.before_lo = sum.lo;
        }
        sum = next;
    }
}
