// Influences: which joints hold a vertex, and by what share of its weights.
//@ use common/bends
//@ use common/pull

// The joint in a lane of a set of four; out of range is held to the last.
fn influences_joint(deform: u32, vertex: u32, four: u32, lane: u32) -> u32 {
    let format = deforms[deform].joints_format[four];
    let byte = deforms[deform].joints_offset[four] + vertex * deforms[deform].joints_stride[four] + lane * pull_bytes(format);
    return deforms[deform].first_joint + min(u32(pull_lane(format, byte)), deforms[deform].joint_count - 1u);
}

fn influences_weight(deform: u32, vertex: u32, four: u32, lane: u32) -> f32 {
    let format = deforms[deform].weights_format[four];
    return pull_lane(format, deforms[deform].weights_offset[four] + vertex * deforms[deform].weights_stride[four] + lane * pull_bytes(format));
}

fn influences_sum(deform: u32, vertex: u32) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < 4u * deforms[deform].sets; i += 1u) { sum += influences_weight(deform, vertex, i / 4u, i % 4u); }
    return sum;
}

// Share of the `i`th joint, given the sum of all weights; whom no weight holds, the first joint does.
fn influences_share(deform: u32, vertex: u32, i: u32, sum: f32) -> f32 {
    let weight = influences_weight(deform, vertex, i / 4u, i % 4u);
    return select(select(0.0, 1.0, i == 0u), weight / select(1.0, sum, sum > 0.0), sum > 0.0);
}
