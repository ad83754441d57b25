// Shapes, kept: what morph targets add to a vertex, each by its weight. Mirror of `gpu::bends::ShapeRecord`.
//@ use common/bends
//@ use common/normal

struct MorphTarget {
    weight: f32,
    position_offset: u32,
    position_stride: u32,
    position_format: u32, // 0: it moves nothing
    normal_offset: u32,
    normal_stride: u32,
    normal_format: u32,
    spare: u32,
}

@group(0) @binding(18) var<storage, read> shapes: array<MorphTarget>;

// What is stored for a vertex; zero where a lane is refused, or nothing stored.
fn shapes_stored(format: u32, byte: u32) -> vec3f {
    if format == 0u { return vec3f(0.0); }
    return normal_gated(pull_bits3(format, byte)).xyz;
}

fn shapes_place(deform: u32, vertex: u32, p: vec3f) -> vec3f {
    var sum = p;
    for (var i = 0u; i < deforms[deform].shape_count; i += 1u) {
        let at = deforms[deform].first_shape + i;
        sum += shapes_stored(shapes[at].position_format, shapes[at].position_offset + vertex * shapes[at].position_stride) * shapes[at].weight;
    }
    return sum;
}

fn shapes_normal(deform: u32, vertex: u32, n: vec3f) -> vec3f {
    var sum = n;
    for (var i = 0u; i < deforms[deform].shape_count; i += 1u) {
        let at = deforms[deform].first_shape + i;
        sum += shapes_stored(shapes[at].normal_format, shapes[at].normal_offset + vertex * shapes[at].normal_stride) * shapes[at].weight;
    }
    return sum;
}
