// order_sums: the number of samples in every block of 1,024 triangles, as a 64-bit number.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/order

@group(0) @binding(5) var<storage, read> sample_counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> sums: array<vec2u>;

var<workgroup> partial: array<Wide, 256>;

@compute @workgroup_size(256)
fn order_sums(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let block = workgroup.y * workgroups.x + workgroup.x;
    var sum = Wide(0u, 0u);
    for (var i = 0u; i < 4u; i += 1u) {
        let id = block * ORDER_BLOCK + invocation_index * 4u + i;
        if id < frame.triangle_count { sum = fixed_add(sum, Wide(0u, sample_counts[id])); }
    }
    partial[invocation_index] = sum;
    workgroupBarrier();
    for (var half = 128u; half > 0u; half /= 2u) {
        if invocation_index < half { partial[invocation_index] = fixed_add(partial[invocation_index], partial[invocation_index + half]); }
        workgroupBarrier();
    }
    if invocation_index == 0u && block * ORDER_BLOCK < frame.triangle_count { sums[block] = vec2u(partial[0].hi, partial[0].lo); }
}
