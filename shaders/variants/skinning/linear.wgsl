// Skinning, linear: a vertex follows the weighted mean of its joints' matrices, as glTF defines it.
//@ use lib/deform

// Three rows per joint.
@group(0) @binding(17) var<storage, read> joints: array<vec4f>;

// Rows of the mean matrix, and whether the draw has joints.
struct Skinning { x: vec4f, y: vec4f, z: vec4f, has_joints: bool }

fn skinning_of(deform: u32, vertex: u32) -> Skinning {
    var s = Skinning(vec4f(0.0), vec4f(0.0), vec4f(0.0), deforms[deform].sets > 0u);
    let sum = influence_sum(deform, vertex);
    for (var i = 0u; i < 4u * deforms[deform].sets; i += 1u) {
        let weight = influence_weight(deform, vertex, i, sum);
        let row = 3u * influence_joint(deform, vertex, i / 4u, i % 4u);
        s.x += joints[row] * weight;
        s.y += joints[row + 1u] * weight;
        s.z += joints[row + 2u] * weight;
    }
    return s;
}

fn skinning_position(s: Skinning, p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return select(p, vec3f(dot(s.x, q), dot(s.y, q), dot(s.z, q)), s.has_joints);
}

// By the matrix's cofactors.
fn skinning_normal(s: Skinning, n: vec3f) -> vec3f {
    let deformed = vec3f(dot(cross(s.y.xyz, s.z.xyz), n), dot(cross(s.z.xyz, s.x.xyz), n), dot(cross(s.x.xyz, s.y.xyz), n));
    return select(n, deformed, s.has_joints);
}
