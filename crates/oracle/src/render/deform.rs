//! Deformation in f64: morph targets first, then joints (glTF 2.0, sections 3.7.2.2 and 3.7.3), by
//! linear blend skinning or by dual quaternions (Kavan et al. 2007).

use glam::{DMat3, DQuat, DVec3};
use rayon::prelude::*;

use super::super::arithmetic::{bits, vector};
use crate::{
    frame::vertex_flags,
    scene::{
        Accessor, Primitive, Scene,
        deformation::MorphTarget,
        draw::{Draw, MAX_MAGNITUDE},
        joint_transforms::{DualQuaternionJoint, JointMatrix, JointTransforms},
        pose::Deform,
    },
};

/// Position of a vertex of `draw` in object space, deformed.
/// Errors: the flags of all components that were refused, or [`vertex_flags::OUT_OF_RANGE`] if
/// deformation takes the vertex out of range.
pub fn position(scene: &Scene, draw: &Draw, vertex: u32) -> Result<DVec3, u32> {
    let stored = stored_position(scene, draw, vertex)?;
    let Some(deform) = &draw.deform else {
        return Ok(stored);
    };
    let primitive = &scene.primitives[draw.primitive];
    let morphed = morphed(scene, primitive, deform, vertex, stored, morph_positions);
    let deformed = match &deform.joint_transforms {
        None => morphed,
        Some(JointTransforms::Linear(joints)) => {
            LinearBlend::of(joints, &joint_weights(scene, primitive, vertex)).position(morphed)
        }
        Some(JointTransforms::Dual(joints)) => {
            DualQuaternionBlend::of(joints, &joint_weights(scene, primitive, vertex))
                .position(morphed)
        }
    };
    if deformed.abs().max_element() >= MAX_MAGNITUDE {
        Err(vertex_flags::OUT_OF_RANGE)
    } else {
        Ok(deformed)
    }
}

/// Normal of a vertex in object space, none if a component is refused. As stored and of any length
/// if nothing deforms the vertex; a deformed one is a unit vector, or zero.
pub fn normal(scene: &Scene, draw: &Draw, vertex: u32) -> Option<DVec3> {
    let stored = stored_normal(scene, draw, vertex)?;
    let Some(deform) = &draw.deform else {
        return Some(stored);
    };
    let primitive = &scene.primitives[draw.primitive];
    let morphed = morphed(scene, primitive, deform, vertex, stored, morph_normals);
    Some(vector::direction(match &deform.joint_transforms {
        None => morphed,
        Some(JointTransforms::Linear(joints)) => {
            LinearBlend::of(joints, &joint_weights(scene, primitive, vertex)).normal(morphed)
        }
        Some(JointTransforms::Dual(joints)) => {
            DualQuaternionBlend::of(joints, &joint_weights(scene, primitive, vertex))
                .normal(morphed)
        }
    }))
}

/// Position and normal of every vertex of a draw that deforms, rounded to f32: what an adapter
/// keeps. Empty for other draws.
pub fn vertices(scene: &Scene, draw: &Draw) -> Vec<[f32; 6]> {
    let vertex = |vertex| {
        let (p, n) = (
            position(scene, draw, vertex).unwrap_or(DVec3::INFINITY),
            normal(scene, draw, vertex).unwrap_or(DVec3::INFINITY),
        );
        [p.x, p.y, p.z, n.x, n.y, n.z].map(|component| component as f32)
    };
    (0..vertex_count(scene, draw))
        .into_par_iter()
        .map(vertex)
        .collect()
}

/// Number of vertices of a draw that deform: all or none.
pub fn vertex_count(scene: &Scene, draw: &Draw) -> u32 {
    if draw.deform.is_some() {
        scene.primitives[draw.primitive].vertex_count()
    } else {
        0
    }
}

/// Volume that the deformed meshes of a picture enclose, in cubic meters, by the divergence
/// theorem: skinning may lose some of it. Of a mesh with holes the value means nothing.
pub fn volume(scene: &Scene, draws: &[Draw]) -> f64 {
    let of_draw = |draw: &Draw| {
        let primitive = &scene.primitives[draw.primitive];
        let corner = |vertex| position(scene, draw, vertex).unwrap_or(DVec3::ZERO);
        let triangle = |triangle| {
            let [a, b, c] = primitive.corners(scene, triangle).map(corner);
            a.dot(b.cross(c)) / 6.0
        };
        (0..primitive.triangle_count()).map(triangle).sum::<f64>()
    };
    draws
        .iter()
        .filter(|draw| draw.deform.is_some())
        .map(of_draw)
        .sum()
}

/// Position of a vertex as the file has it.
/// Errors: the flags of all components that were refused.
pub fn stored_position(scene: &Scene, draw: &Draw, vertex: u32) -> Result<DVec3, u32> {
    let positions = &scene.primitives[draw.primitive].positions;
    match components(scene, positions, vertex) {
        [Ok(x), Ok(y), Ok(z)] => Ok(DVec3::new(x, y, z)),
        refused => Err(refused
            .iter()
            .filter_map(|component| component.err())
            .fold(0, |all, flag| all | flag)),
    }
}

/// Normal of a vertex as the file has it; none if a component is refused.
pub fn stored_normal(scene: &Scene, draw: &Draw, vertex: u32) -> Option<DVec3> {
    match components(scene, &scene.primitives[draw.primitive].normals, vertex) {
        [Ok(x), Ok(y), Ok(z)] => Some(DVec3::new(x, y, z)),
        _ => None,
    }
}

fn components(scene: &Scene, accessor: &Accessor, vertex: u32) -> [Result<f64, u32>; 3] {
    [0, 1, 2].map(|component| bits::component(&scene.vertex_bytes, accessor, vertex, component))
}

/// Which attribute of a morph target is meant.
pub type MorphAttribute = fn(&MorphTarget) -> Option<&Accessor>;

/// The positions that a morph target adds.
pub fn morph_positions(shape: &MorphTarget) -> Option<&Accessor> {
    shape.positions.as_ref()
}

/// The normals that a morph target adds.
pub fn morph_normals(shape: &MorphTarget) -> Option<&Accessor> {
    shape.normals.as_ref()
}

/// A stored vector plus the weighted vectors of all morph targets.
pub fn morphed(
    scene: &Scene,
    primitive: &Primitive,
    deform: &Deform,
    vertex: u32,
    stored: DVec3,
    attribute: MorphAttribute,
) -> DVec3 {
    morph_terms(scene, primitive, deform, vertex, attribute)
        .fold(stored, |sum, (term, _)| sum + term)
}

/// What the morph targets with a weight add to a vertex, each with the accessor it comes from. A
/// target with a component that is refused adds nothing.
pub fn morph_terms<'a>(
    scene: &'a Scene,
    primitive: &'a Primitive,
    deform: &'a Deform,
    vertex: u32,
    attribute: MorphAttribute,
) -> impl Iterator<Item = (DVec3, &'a Accessor)> {
    deform
        .weights
        .iter()
        .zip(&primitive.deformation.morph_targets)
        .filter_map(move |(&weight, shape)| {
            let accessor = attribute(shape).filter(|_| weight != 0.0)?;
            let [Ok(x), Ok(y), Ok(z)] = components(scene, accessor, vertex) else {
                return None;
            };
            Some((DVec3::new(x, y, z) * f64::from(weight), accessor))
        })
}

/// Joints of a vertex with their weights, which sum to 1. The first joint holds a vertex that no
/// weight holds.
pub fn joint_weights(scene: &Scene, primitive: &Primitive, vertex: u32) -> Vec<(usize, f64)> {
    let bytes = &scene.vertex_bytes;
    let sets = primitive.deformation.influences.iter();
    let mut weights: Vec<(usize, f64)> = sets
        .flat_map(|set| {
            [0, 1, 2, 3].map(|i| {
                (
                    set.joints.integer(bytes, vertex, i) as usize,
                    set.weights.value(bytes, vertex, i),
                )
            })
        })
        .collect();
    let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
    for (index, (_, weight)) in weights.iter_mut().enumerate() {
        *weight = if sum > 0.0 {
            *weight / sum
        } else {
            f64::from(u8::from(index == 0))
        };
    }
    weights
}

/// Linear blend skinning: the weighted mean of the joints' matrices.
pub struct LinearBlend {
    matrix: DMat3,
    origin: DVec3,
}

impl LinearBlend {
    pub fn of(joints: &[JointMatrix], weights: &[(usize, f64)]) -> Self {
        let mut blend = Self {
            matrix: DMat3::ZERO,
            origin: DVec3::ZERO,
        };
        for &(joint, weight) in weights {
            let [x, y, z, origin] = weighted_columns(&joints[joint], weight);
            blend.matrix += DMat3::from_cols(x, y, z);
            blend.origin += origin;
        }
        blend
    }

    pub fn position(&self, position: DVec3) -> DVec3 {
        self.matrix * position + self.origin
    }

    pub fn normal(&self, normal: DVec3) -> DVec3 {
        vector::cofactors(&self.matrix) * normal
    }
}

/// Columns of a joint's matrix, the last of them the translation, times a weight.
pub fn weighted_columns(joint: &JointMatrix, weight: f64) -> [DVec3; 4] {
    [0, 1, 2, 3].map(|c: usize| {
        DVec3::new(joint[0][c].into(), joint[1][c].into(), joint[2][c].into()) * weight
    })
}

/// Dual quaternion blend skinning: the joints' stretches are averaged as matrices, their rigid
/// motions as dual quaternions, so that lengths are preserved.
pub struct DualQuaternionBlend {
    stretch: DMat3,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// The dual part, divided by [`Self::length`].
    pub dual: DQuat,
    translation: DVec3,
    /// Length of the weighted sum of the real parts.
    pub length: f64,
}

impl DualQuaternionBlend {
    pub fn of(joints: &[DualQuaternionJoint], weights: &[(usize, f64)]) -> Self {
        let pivot = quaternion(joints[weights[0].0].real);
        let zero = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let (mut real, mut dual, mut stretch) = (zero, zero, DMat3::ZERO);
        for &(joint, weight) in weights {
            let joint = &joints[joint];
            let [x, y, z] = weighted_rows(joint, weight);
            stretch += DMat3::from_cols(x, y, z).transpose();
            // q and -q are the same rotation: take the one nearer to the first joint's.
            let signed = if pivot.dot(quaternion(joint.real)) < 0.0 {
                -weight
            } else {
                weight
            };
            real += quaternion(joint.real) * signed;
            dual += quaternion(joint.dual) * signed;
        }
        let length = real.length();
        let (rotation, dual) = (real * (1.0 / length), dual * (1.0 / length));
        let (r, d) = (
            DVec3::new(rotation.x, rotation.y, rotation.z),
            DVec3::new(dual.x, dual.y, dual.z),
        );
        let translation = 2.0 * (rotation.w * d - dual.w * r + r.cross(d));
        Self {
            stretch,
            rotation,
            dual,
            translation,
            length,
        }
    }

    pub fn stretched(&self, position: DVec3) -> DVec3 {
        self.stretch * position
    }

    pub fn stretched_normal(&self, normal: DVec3) -> DVec3 {
        vector::cofactors(&self.stretch) * normal
    }

    pub fn position(&self, position: DVec3) -> DVec3 {
        self.rotated(self.stretched(position)) + self.translation
    }

    pub fn normal(&self, normal: DVec3) -> DVec3 {
        self.rotated(self.stretched_normal(normal))
    }

    fn rotated(&self, v: DVec3) -> DVec3 {
        let r = DVec3::new(self.rotation.x, self.rotation.y, self.rotation.z);
        v + 2.0 * r.cross(r.cross(v) + self.rotation.w * v)
    }
}

/// Rows of a joint's stretch, times a weight.
pub fn weighted_rows(joint: &DualQuaternionJoint, weight: f64) -> [DVec3; 3] {
    joint
        .stretch
        .map(|row| DVec3::new(row[0].into(), row[1].into(), row[2].into()) * weight)
}

/// A stored quaternion.
pub fn quaternion(q: [f32; 4]) -> DQuat {
    DQuat::from_array(q.map(f64::from))
}
