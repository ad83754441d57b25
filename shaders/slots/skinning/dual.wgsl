// Skinning, dual: dot_runs are averaged as matrices, then rigid motions as dual quaternions, which keep lengths (Kavan et
// al. 2007). Quaternions are x y z w.
//@ use common/influences

// Per joint: rotation, dual part, three rows of the stretch.
@group(0) @binding(17) var<storage, read> joints: array<vec4f>;

struct Skinning { real: vec4f, dual: vec4f, x: vec3f, y: vec3f, z: vec3f, is_held: bool }

fn skinning_of(deform: u32, vertex: u32) -> Skinning {
    var s: Skinning;
    s.is_held = deforms[deform].sets > 0u;
    if !s.is_held { return s; }
    let sum = influences_sum(deform, vertex);
    let pivot = joints[5u * influences_joint(deform, vertex, 0u, 0u)];
    for (var i = 0u; i < 4u * deforms[deform].sets; i += 1u) {
        let share = influences_share(deform, vertex, i, sum);
        let row = 5u * influences_joint(deform, vertex, i / 4u, i % 4u);
        // A rotation and its opposite are the same: take the one on the side of the first joint's.
        let signed = select(share, -share, dot(pivot, joints[row]) < 0.0);
        s.real += joints[row] * signed;
        s.dual += joints[row + 1u] * signed;
        s.x += joints[row + 2u].xyz * share;
        s.y += joints[row + 3u].xyz * share;
        s.z += joints[row + 4u].xyz * share;
    }
    let norm = length(s.real);
    s.real /= norm;
    s.dual /= norm;
    return s;
}

fn skinning_turned(s: Skinning, v: vec3f) -> vec3f {
    return v + 2.0 * cross(s.real.xyz, cross(s.real.xyz, v) + s.real.w * v);
}

fn skinning_place(s: Skinning, p: vec3f) -> vec3f {
    let stretched = vec3f(dot(s.x, p), dot(s.y, p), dot(s.z, p));
    let shift = 2.0 * (s.real.w * s.dual.xyz - s.dual.w * s.real.xyz + cross(s.real.xyz, s.dual.xyz));
    return select(p, skinning_turned(s, stretched) + shift, s.is_held);
}

// By the stretch's cofactors, of any length.
fn skinning_normal(s: Skinning, n: vec3f) -> vec3f {
    let stretched = vec3f(dot(cross(s.y, s.z), n), dot(cross(s.z, s.x), n), dot(cross(s.x, s.y), n));
    return select(n, skinning_turned(s, stretched), s.is_held);
}
