// Order sums: samples of every block of 1,024 triangles, in two words.
//@ use common/frame
//@ use common/fixed

@group(0) @binding(5) var<storage, read> sample_counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> sums: array<vec2u>;

var<workgroup> partial: array<Wide, 256>;

@compute @workgroup_size(256)
fn order_sums(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let block = group.y * groups.x + group.x;
    var sum = Wide(0u, 0u);
    for (var i = 0u; i < 4u; i += 1u) {
        let id = block * 1024u + lane * 4u + i;
        if id < frame.triangle_count { sum = fixed_add(sum, Wide(0u, sample_counts[id])); }
    }
    partial[lane] = sum;
    workgroupBarrier();
    for (var half = 128u; half > 0u; half /= 2u) {
        if lane < half { partial[lane] = fixed_add(partial[lane], partial[lane + half]); }
        workgroupBarrier();
    }
    if lane == 0u && block * 1024u < frame.triangle_count { sums[block] = vec2u(partial[0].hi, partial[0].lo); }
}
