// Order ranks: for every triangle, which share of all samples comes before it.
//@ use common/frame
//@ use common/fixed
//@ use common/order
//@ use slot/records

@group(0) @binding(5) var<storage, read> sample_counts: array<u32>;
@group(0) @binding(6) var<storage, read> sums: array<vec2u>;
@group(0) @binding(14) var<uniform> order: Order;

var<workgroup> partial: array<Wide, 256>;

@compute @workgroup_size(256)
fn order_ranks(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let block = group.y * groups.x + group.x;
    let begin = block * 1024u + lane * 4u;
    var mine = vec4u(0u);
    var sum = Wide(0u, 0u);
    for (var i = 0u; i < 4u; i += 1u) {
        if begin + i < frame.triangle_count { mine[i] = sample_counts[begin + i]; }
        sum = fixed_add(sum, Wide(0u, mine[i]));
    }
    partial[lane] = sum;
    workgroupBarrier();
    // Sums of lanes up to and with this one (Hillis and Steele 1986).
    for (var step = 1u; step < 256u; step *= 2u) {
        var other = Wide(0u, 0u);
        if lane >= step { other = partial[lane - step]; }
        workgroupBarrier();
        partial[lane] = fixed_add(partial[lane], other);
        workgroupBarrier();
    }
    if begin >= frame.triangle_count { return; }
    var rank = fixed_sub(fixed_add(Wide(sums[block].x, sums[block].y), partial[lane]), sum);
    let total = max(fixed_to_f32(Wide(order.total_hi, order.total_lo)), 1.0);
    var ranks: vec4u;
    for (var i = 0u; i < 4u; i += 1u) {
        ranks[i] = bitcast<u32>(fixed_to_f32(rank) / total);
        rank = fixed_add(rank, Wide(0u, mine[i]));
    }
    vertices[frame.first_rank + begin / 4u] = ranks;
}
