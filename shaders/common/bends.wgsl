// Deforms: every draw whose vertices are bent, with where their bytes lie. Mirror of `gpu::bends::DeformRecord`.
//@ use common/frame

struct Deform {
    first: u32,            // of its vertices, among those of all draws that may bend
    count: u32,
    target_word: u32,      // where its bent vertices begin: six words each, position and normal
    position_offset: u32,
    position_stride: u32,
    position_format: u32,  // as `common/pull` has them, as are all below
    normal_offset: u32,
    normal_stride: u32,
    normal_format: u32,
    first_joint: u32,
    joints_offset: vec2u,  // of the first and second four joints of a vertex
    joints_stride: vec2u,
    joints_format: vec2u,
    weights_offset: vec2u,
    weights_stride: vec2u,
    weights_format: vec2u,
    sets: u32,             // fours of joints; 0 where no joint holds it
    joint_count: u32,
    first_shape: u32,
    shape_count: u32,
}

@group(0) @binding(16) var<storage, read> deforms: array<Deform>;

// The last draw that does not begin after vertex `id` of all that may bend.
fn deforms_of(id: u32) -> u32 {
    var low = 0u;
    var high = frame.deform_count;
    for (var step = 0u; step < 32u && high - low > 1u; step += 1u) {
        let middle = (low + high) / 2u;
        if deforms[middle].first <= id { low = middle; } else { high = middle; }
    }
    return low;
}
