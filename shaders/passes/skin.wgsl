// Skin: mixes the shapes of a mesh, then bends it as its joints say, once per vertex of every draw that bends. Positions and
// normals are kept as floats behind the file's bytes, where all later passes pull them as if the file had them.
//@ use common/bends
//@ use common/normal
//@ use slot/shapes
//@ use slot/skinning

fn skin_store(word: u32, bits: vec3u) {
    vertex_bytes[word] = bits.x;
    vertex_bytes[word + 1u] = bits.y;
    vertex_bytes[word + 2u] = bits.z;
}

@compute @workgroup_size(GROUP_SIZE)
fn skin(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let id = frame_invocation(group, groups, lane, GROUP_SIZE);
    let deform = deforms_of(id);
    let vertex = id - deforms[deform].first;
    // Draws that may bend and do not at this moment leave gaps.
    if id < deforms[deform].first || vertex >= deforms[deform].count { return; }
    let skinning = skinning_of(deform, vertex);
    let word = deforms[deform].target_word + 6u * vertex;

    // What cannot be drawn stays what it is, for the projection to refuse.
    let place = pull_bits3(deforms[deform].position_format, deforms[deform].position_offset + vertex * deforms[deform].position_stride);
    let gate = vertex_gate(place);
    let deformed = skinning_place(skinning, shapes_place(deform, vertex, vertex_position(place, gate)));
    skin_store(word, select(place, bitcast<vec3u>(deformed), gate == 0u));

    let stored = pull_bits3(deforms[deform].normal_format, deforms[deform].normal_offset + vertex * deforms[deform].normal_stride);
    let normal = normal_gated(stored);
    let turned = normal_direction(skinning_normal(skinning, shapes_normal(deform, vertex, normal.xyz)));
    skin_store(word + 3u, select(stored, bitcast<vec3u>(turned), normal.w != 0.0));
}
