// deform: adds morph targets to every vertex of the deformed draws, then lets its joints move it. Positions and normals are stored
// as floats behind the file's bytes, where all later passes pull them as if the file contained them.
//@ use lib/frame
//@ use lib/attributes
//@ use lib/geometry
//@ use lib/deform
//@ use variants/morph_targets
//@ use variants/skinning

@group(0) @binding(2) var<storage, read_write> vertex_bytes: array<u32>;

fn deform_store(word: u32, bits: vec3u) {
    vertex_bytes[word] = bits.x;
    vertex_bytes[word + 1u] = bits.y;
    vertex_bytes[word + 2u] = bits.z;
}

@compute @workgroup_size(GROUP_SIZE)
fn deform(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let id = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    let draw = deforms_of(id);
    let vertex = id - deforms[draw].first;
    // Draws that can be deformed but are not in this frame leave gaps.
    if id < deforms[draw].first || vertex >= deforms[draw].count { return; }
    let skinning = skinning_of(draw, vertex);
    let word = deforms[draw].target_word + 6u * vertex;

    // A rejected position or normal keeps its bits, for the projection to reject.
    let position = pull_bits3(deforms[draw].position_format, deforms[draw].position_offset + vertex * deforms[draw].position_stride);
    let class_of_bits = bit_class(position);
    let deformed = skinning_position(skinning, morph_targets_position(draw, vertex, floats_of_class(position, class_of_bits)));
    deform_store(word, select(position, bitcast<vec3u>(deformed), class_of_bits == 0u));

    let stored = pull_bits3(deforms[draw].normal_format, deforms[draw].normal_offset + vertex * deforms[draw].normal_stride);
    let normal = normal_from_bits(stored);
    let turned = normal_direction(skinning_normal(skinning, morph_targets_normal(draw, vertex, normal.xyz)));
    deform_store(word + 3u, select(stored, bitcast<vec3u>(turned), normal.w != 0.0));
}
