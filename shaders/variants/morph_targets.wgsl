// Morph targets: offsets added to a vertex, before joints move it.
// Chosen where a mesh has morph targets: weighted.
//
//@ declare fn morph_targets_position(deform: u32, vertex: u32, p: vec3f) -> vec3f
//@ declare fn morph_targets_normal(deform: u32, vertex: u32, n: vec3f) -> vec3f

//@ variant default
// Nothing is added.

fn morph_targets_position(deform: u32, vertex: u32, p: vec3f) -> vec3f {
    return p;
}

fn morph_targets_normal(deform: u32, vertex: u32, n: vec3f) -> vec3f {
    return n;
}

//@ variant weighted
// Each adds its offset times its weight. Mirrors `gpu::records::MorphTargetRecord`.
//@ use lib/attributes
//@ use lib/deform

struct MorphTarget {
    weight: f32,
    position_offset: u32,
    position_stride: u32,
    position_format: u32, // 0: no positions
    normal_offset: u32,
    normal_stride: u32,
    normal_format: u32,   // 0: no normals
    spare: u32,
}

@group(0) @binding(18) var<storage, read> morph_targets: array<MorphTarget>;

// The stored offset of a vertex; zero where there is none or a component is rejected.
fn morph_targets_stored(format: u32, byte: u32) -> vec3f {
    if format == 0u { return vec3f(0.0); }
    return normal_from_bits(pull_bits3(format, byte)).xyz;
}

fn morph_targets_position(deform: u32, vertex: u32, p: vec3f) -> vec3f {
    var sum = p;
    for (var i = 0u; i < deforms[deform].shape_count; i += 1u) {
        let at = deforms[deform].first_shape + i;
        sum += morph_targets_stored(morph_targets[at].position_format, morph_targets[at].position_offset + vertex * morph_targets[at].position_stride) * morph_targets[at].weight;
    }
    return sum;
}

fn morph_targets_normal(deform: u32, vertex: u32, n: vec3f) -> vec3f {
    var sum = n;
    for (var i = 0u; i < deforms[deform].shape_count; i += 1u) {
        let at = deforms[deform].first_shape + i;
        sum += morph_targets_stored(morph_targets[at].normal_format, morph_targets[at].normal_offset + vertex * morph_targets[at].normal_stride) * morph_targets[at].weight;
    }
    return sum;
}
