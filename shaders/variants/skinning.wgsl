// Skinning: how joints move a vertex.
// Chosen by the accuracy axis `skinning` where a mesh has joints.
//
// The motion of one vertex.
//@ declare struct Skinning
// Of a vertex of a deformed draw.
//@ declare fn skinning_of(deform: u32, vertex: u32) -> Skinning
//@ declare fn skinning_position(s: Skinning, p: vec3f) -> vec3f
// A normal of any length.
//@ declare fn skinning_normal(s: Skinning, n: vec3f) -> vec3f

//@ variant default
// No joint moves anything: for morph targets alone.

struct Skinning { spare: u32 }

fn skinning_of(deform: u32, vertex: u32) -> Skinning {
    return Skinning(0u);
}

fn skinning_position(s: Skinning, p: vec3f) -> vec3f {
    return p;
}

fn skinning_normal(s: Skinning, n: vec3f) -> vec3f {
    return n;
}

//@ variant linear
// A vertex follows the weighted mean of its joints' matrices, as glTF defines it.
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

//@ variant dual
// Stretches are averaged as matrices, rigid motions as dual quaternions, which preserve lengths (Kavan et
// al. 2007). Quaternions are x y z w.
//@ use lib/deform

// Per joint: rotation, dual part, three rows of the stretch.
@group(0) @binding(17) var<storage, read> joints: array<vec4f>;

struct Skinning { real: vec4f, dual: vec4f, x: vec3f, y: vec3f, z: vec3f, has_joints: bool }

fn skinning_of(deform: u32, vertex: u32) -> Skinning {
    var s: Skinning;
    s.has_joints = deforms[deform].sets > 0u;
    if !s.has_joints { return s; }
    let sum = influence_sum(deform, vertex);
    let pivot = joints[5u * influence_joint(deform, vertex, 0u, 0u)];
    for (var i = 0u; i < 4u * deforms[deform].sets; i += 1u) {
        let weight = influence_weight(deform, vertex, i, sum);
        let row = 5u * influence_joint(deform, vertex, i / 4u, i % 4u);
        // A quaternion and its negative are the same rotation: take the one on the side of the first joint's.
        let signed = select(weight, -weight, dot(pivot, joints[row]) < 0.0);
        s.real += joints[row] * signed;
        s.dual += joints[row + 1u] * signed;
        s.x += joints[row + 2u].xyz * weight;
        s.y += joints[row + 3u].xyz * weight;
        s.z += joints[row + 4u].xyz * weight;
    }
    let norm = length(s.real);
    s.real /= norm;
    s.dual /= norm;
    return s;
}

fn skinning_rotated(s: Skinning, v: vec3f) -> vec3f {
    return v + 2.0 * cross(s.real.xyz, cross(s.real.xyz, v) + s.real.w * v);
}

fn skinning_position(s: Skinning, p: vec3f) -> vec3f {
    let stretched = vec3f(dot(s.x, p), dot(s.y, p), dot(s.z, p));
    let shift = 2.0 * (s.real.w * s.dual.xyz - s.dual.w * s.real.xyz + cross(s.real.xyz, s.dual.xyz));
    return select(p, skinning_rotated(s, stretched) + shift, s.has_joints);
}

// By the stretch's cofactors.
fn skinning_normal(s: Skinning, n: vec3f) -> vec3f {
    let stretched = vec3f(dot(cross(s.y, s.z), n), dot(cross(s.z, s.x), n), dot(cross(s.x, s.y), n));
    return select(n, skinning_rotated(s, stretched), s.has_joints);
}
