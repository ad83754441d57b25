// Skinning, linear: a vertex follows the mean of its joints' matrices, as glTF has it.
//@ use common/influences

// Three rows per joint.
@group(0) @binding(17) var<storage, read> joints: array<vec4f>;

// Rows of the mean matrix, and whether there is one.
struct Skinning { x: vec4f, y: vec4f, z: vec4f, is_held: bool }

fn skinning_of(deform: u32, vertex: u32) -> Skinning {
    var s = Skinning(vec4f(0.0), vec4f(0.0), vec4f(0.0), deforms[deform].sets > 0u);
    let sum = influences_sum(deform, vertex);
    for (var i = 0u; i < 4u * deforms[deform].sets; i += 1u) {
        let share = influences_share(deform, vertex, i, sum);
        let row = 3u * influences_joint(deform, vertex, i / 4u, i % 4u);
        s.x += joints[row] * share;
        s.y += joints[row + 1u] * share;
        s.z += joints[row + 2u] * share;
    }
    return s;
}

fn skinning_place(s: Skinning, p: vec3f) -> vec3f {
    let q = vec4f(p, 1.0);
    return select(p, vec3f(dot(s.x, q), dot(s.y, q), dot(s.z, q)), s.is_held);
}

// By the matrix's cofactors, of any length.
fn skinning_normal(s: Skinning, n: vec3f) -> vec3f {
    let deformed = vec3f(dot(cross(s.y.xyz, s.z.xyz), n), dot(cross(s.z.xyz, s.x.xyz), n), dot(cross(s.x.xyz, s.y.xyz), n));
    return select(n, deformed, s.is_held);
}
