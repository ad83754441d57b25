// order_ranks: for every triangle, the fraction of all samples that come before it.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/order
//@ use lib/order_scan

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;
@group(0) @binding(5) var<storage, read> sample_counts: array<u32>;
@group(0) @binding(6) var<storage, read> sums: array<vec2u>;
@group(0) @binding(14) var<uniform> order: Order;

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
    let before = order_scan(invocation_index, sum);
    if begin >= frame.triangle_count { return; }
    var rank = fixed_add(Wide(sums[block].x, sums[block].y), before);
    let total = max(fixed_to_f32(Wide(order.total_hi, order.total_lo)), 1.0);
    var ranks: vec4u;
    for (var i = 0u; i < 4u; i += 1u) {
        ranks[i] = bitcast<u32>(fixed_to_f32(rank) / total);
        rank = fixed_add(rank, Wide(0u, mine[i]));
    }
    vertices[frame.first_rank + begin / 4u] = ranks;
}
