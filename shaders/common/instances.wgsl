// Instances: what culling knows of every draw. Mirror of `gpu::culling::InstanceRecord`.
//@ use common/frame

struct Instance {
    eye: vec4f,          // object space, from the draw's origin where places are relative. w: 1 or -1, for which side of a triangle is seen from there; 0: xyz is the viewing direction
    center: vec4f,       // middle of a box round it, object space. w: area on screen of a unit of area at w = 1 that faces the eye
    half: vec4f,         // half its sides. w: most units that a metre within it is long on screen at w = 1
    first: u32,          // of its meshlets, counted over all instances
    first_meshlet: u32,  // the record of that one
    flags: u32,
    spare: u32,
}

const INSTANCE_FACES = 1u; // shows one side of its triangles
const INSTANCE_DEFORMS = 2u; // its meshlets are nowhere near their bounds; its own box holds

@group(0) @binding(27) var<storage, read> instances: array<Instance>;

// The last instance that does not begin after meshlet `id` of all.
fn instances_of(id: u32) -> u32 {
    var low = 0u;
    var high = frame.draw_count;
    for (var step = 0u; step < 32u && high - low > 1u; step += 1u) {
        let middle = (low + high) / 2u;
        if instances[middle].first <= id { low = middle; } else { high = middle; }
    }
    return low;
}
