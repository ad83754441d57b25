// Deformed draws: those whose vertices follow joints or morph targets, and where their bytes are.
// Mirrors `gpu::records::DeformRecord`.
//@ use lib/frame
//@ use lib/attributes

struct Deform {
    first: u32,            // its first vertex, among the vertices of all draws that may be deformed
    count: u32,
    target_word: u32,      // where its deformed vertices begin: six words each, position and normal
    position_offset: u32,
    position_stride: u32,
    position_format: u32,  // format word of lib/attributes, as are all below
    normal_offset: u32,
    normal_stride: u32,
    normal_format: u32,
    first_joint: u32,
    joints_offset: vec2u,  // of the first and the second set of four joints
    joints_stride: vec2u,
    joints_format: vec2u,
    weights_offset: vec2u,
    weights_stride: vec2u,
    weights_format: vec2u,
    sets: u32,             // sets of four joints; 0 without joints
    joint_count: u32,
    first_shape: u32,      // morph targets
    shape_count: u32,
}

@group(0) @binding(16) var<storage, read> deforms: array<Deform>;

// The draw of a vertex that is counted over all draws that may be deformed.
fn deforms_of(id: u32) -> u32 {
    var search = search_begin(frame.deform_count);
    for (var i = 0u; i < SEARCH_STEPS && search_is_open(search); i += 1u) {
        search = search_narrow(search, deforms[search_middle(search)].first <= id);
    }
    return search.low;
}

// The joint in a component of a set of four; an index out of range means the last joint.
fn influence_joint(deform: u32, vertex: u32, four: u32, component: u32) -> u32 {
    let format = deforms[deform].joints_format[four];
    let byte = deforms[deform].joints_offset[four] + vertex * deforms[deform].joints_stride[four] + component * pull_bytes(format);
    return deforms[deform].first_joint + min(u32(pull_component(format, byte)), deforms[deform].joint_count - 1u);
}

fn influence_stored_weight(deform: u32, vertex: u32, four: u32, component: u32) -> f32 {
    let format = deforms[deform].weights_format[four];
    return pull_component(
        format, deforms[deform].weights_offset[four] + vertex * deforms[deform].weights_stride[four] + component * pull_bytes(format));
}

// Sum of the stored weights of all joints of a vertex.
fn influence_sum(deform: u32, vertex: u32) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < 4u * deforms[deform].sets; i += 1u) { sum += influence_stored_weight(deform, vertex, i / 4u, i % 4u); }
    return sum;
}

// Normalized weight of the `i`th joint, given the sum of the stored weights; where that sum is 0, the first joint has all weight.
fn influence_weight(deform: u32, vertex: u32, i: u32, sum: f32) -> f32 {
    let weight = influence_stored_weight(deform, vertex, i / 4u, i % 4u);
    return select(select(0.0, 1.0, i == 0u), weight / select(1.0, sum, sum > 0.0), sum > 0.0);
}
