// order_ranks: for every triangle, the fraction of all samples that come before it.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/order

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;
@group(0) @binding(5) var<storage, read> sample_counts: array<u32>;
@group(0) @binding(6) var<storage, read> sums: array<vec2u>;
@group(0) @binding(14) var<uniform> order: Order;

var<workgroup> partial: array<Wide, 256>;

@compute @workgroup_size(256)
fn order_ranks(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let block = workgroup.y * workgroups.x + workgroup.x;
    let begin = block * ORDER_BLOCK + invocation_index * 4u;
    var mine = vec4u(0u);
    var sum = Wide(0u, 0u);
    for (var i = 0u; i < 4u; i += 1u) {
        if begin + i < frame.triangle_count { mine[i] = sample_counts[begin + i]; }
        sum = fixed_add(sum, Wide(0u, mine[i]));
    }
    partial[invocation_index] = sum;
    workgroupBarrier();
    // Inclusive prefix sums over the invocations (Hillis and Steele 1986).
    for (var step = 1u; step < 256u; step *= 2u) {
        var other = Wide(0u, 0u);
        if invocation_index >= step { other = partial[invocation_index - step]; }
        workgroupBarrier();
        partial[invocation_index] = fixed_add(partial[invocation_index], other);
        workgroupBarrier();
    }
    if begin >= frame.triangle_count { return; }
    var rank = fixed_sub(fixed_add(Wide(sums[block].x, sums[block].y), partial[invocation_index]), sum);
    let total = max(fixed_to_f32(Wide(order.total_hi, order.total_lo)), 1.0);
    var ranks: vec4u;
    for (var i = 0u; i < 4u; i += 1u) {
        ranks[i] = bitcast<u32>(fixed_to_f32(rank) / total);
        rank = fixed_add(rank, Wide(0u, mine[i]));
    }
    vertices[frame.first_rank + begin / 4u] = ranks;
}
