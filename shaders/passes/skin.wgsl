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

@compute @workgroup_size(LIST_GROUP)
fn skin(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let id = frame_invocation(group, groups, lane, LIST_GROUP);
    let bend = bends_of(id);
    let vertex = id - bends[bend].first;
    // Draws that may bend and do not at this moment leave gaps.
    if id < bends[bend].first || vertex >= bends[bend].count { return; }
    let skinning = skinning_of(bend, vertex);
    let word = bends[bend].target_word + 6u * vertex;

    // What cannot be drawn stays what it is, for the projection to refuse.
    let place = pull_bits3(bends[bend].position_format, bends[bend].position_offset + vertex * bends[bend].position_stride);
    let gate = vertex_gate(place);
    let bent = skinning_place(skinning, shapes_place(bend, vertex, vertex_position(place, gate)));
    skin_store(word, select(place, bitcast<vec3u>(bent), gate == 0u));

    let stored = pull_bits3(bends[bend].normal_format, bends[bend].normal_offset + vertex * bends[bend].normal_stride);
    let normal = normal_gated(stored);
    let turned = normal_direction(skinning_normal(skinning, shapes_normal(bend, vertex, normal.xyz)));
    skin_store(word + 3u, select(stored, bitcast<vec3u>(turned), normal.w != 0.0));
}
