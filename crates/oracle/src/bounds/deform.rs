//! How far f32 arithmetic may be from the deformation of [`super::super::render::deform`], for any
//! order, rounding and fusion of operations that WGSL allows (`docs/exactness.md` §9).

use glam::{DMat3, DVec3};

use super::super::{
    arithmetic::vector::cross_magnitudes,
    render::deform::{
        self, DualQuaternionBlend, LinearBlend, MorphAttribute, joint_weights, morph_normals,
        morph_positions, morph_terms, morphed, quaternion, weighted_columns, weighted_rows,
    },
};
use crate::{
    effects::hooks::ROUNDING,
    scene::{
        Accessor, ComponentType, Primitive, Scene,
        draw::Draw,
        joint_transforms::{DualQuaternionJoint, JointMatrix, JointTransforms},
        pose::Deform,
    },
};

/// A value with the largest error that f32 arithmetic may make of it, per axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bounded {
    pub value: DVec3,
    pub error: DVec3,
}

/// Second-order terms: products of two errors, which are a sixteenth of the first-order ones at
/// most.
const SECOND_ORDER: f64 = 17.0 / 16.0;

/// Errors of results below the normal numbers, which f32 may flush to zero.
const UNDERFLOW: f64 = 4.0 * f32::MIN_POSITIVE as f64;

/// [`deform::position`] with its bound.
pub fn position(scene: &Scene, draw: &Draw, vertex: u32) -> Result<Bounded, u32> {
    let value = deform::position(scene, draw, vertex)?;
    let stored = deform::stored_position(scene, draw, vertex)?;
    let primitive = &scene.primitives[draw.primitive];
    let Some(deform) = &draw.deform else {
        return Ok(Bounded {
            value,
            error: stored.abs() * fetch_error(&primitive.positions),
        });
    };
    let given = bounded_morph(
        scene,
        primitive,
        deform,
        vertex,
        stored,
        &primitive.positions,
        morph_positions,
    );
    let error = match &deform.joint_transforms {
        None => given.error,
        Some(JointTransforms::Linear(joints)) => {
            LinearBlendError::of(joints, &joint_weights(scene, primitive, vertex)).position(&given)
        }
        Some(JointTransforms::Dual(joints)) => {
            DualQuaternionError::of(joints, &joint_weights(scene, primitive, vertex))
                .position(&given, value)
        }
    };
    Ok(Bounded { value, error })
}

/// [`deform::normal`] with its bound.
pub fn normal(scene: &Scene, draw: &Draw, vertex: u32) -> Option<Bounded> {
    let value = deform::normal(scene, draw, vertex)?;
    let stored = deform::stored_normal(scene, draw, vertex)?;
    let primitive = &scene.primitives[draw.primitive];
    let Some(deform) = &draw.deform else {
        return Some(Bounded {
            value,
            error: stored.abs() * fetch_error(&primitive.normals),
        });
    };
    let given = bounded_morph(
        scene,
        primitive,
        deform,
        vertex,
        stored,
        &primitive.normals,
        morph_normals,
    );
    let deformed = match &deform.joint_transforms {
        None => given,
        Some(JointTransforms::Linear(joints)) => {
            LinearBlendError::of(joints, &joint_weights(scene, primitive, vertex)).normal(&given)
        }
        Some(JointTransforms::Dual(joints)) => {
            DualQuaternionError::of(joints, &joint_weights(scene, primitive, vertex)).normal(&given)
        }
    };
    Some(Bounded {
        value,
        error: DVec3::splat(direction_error(&deformed)),
    })
}

/// Error of the direction of a vector along any axis; 2 where the direction itself is in doubt.
fn direction_error(vector: &Bounded) -> f64 {
    let (length, error) = (vector.value.length(), vector.error.length());
    if error < 0.5 * length {
        error / (length - error) + 8.0 * ROUNDING
    } else {
        2.0
    }
}

/// Relative error of a component as it is fetched: normalized integers are divided.
fn fetch_error(accessor: &Accessor) -> f64 {
    if accessor.normalized && accessor.component_type != ComponentType::F32 {
        3.0 * ROUNDING
    } else {
        0.0
    }
}

/// A stored vector plus the morph targets, with the bound of that sum.
fn bounded_morph(
    scene: &Scene,
    primitive: &Primitive,
    deform: &Deform,
    vertex: u32,
    stored: DVec3,
    accessor: &Accessor,
    attribute: MorphAttribute,
) -> Bounded {
    let mut magnitude = stored.abs() * (1.0 + fetch_error(accessor));
    let (mut fetched, mut terms) = (stored.abs() * fetch_error(accessor), 0);
    for (term, accessor) in morph_terms(scene, primitive, deform, vertex, attribute) {
        magnitude += term.abs();
        fetched += term.abs() * fetch_error(accessor);
        terms += 1;
    }
    let summed = magnitude * (f64::from(terms + 1) * ROUNDING * f64::from(u8::from(terms > 0)));
    Bounded {
        value: morphed(scene, primitive, deform, vertex, stored, attribute),
        error: fetched + summed,
    }
}

/// Relative error of anything that is averaged by `count` joint weights: each weight is fetched
/// (3), all are added (n), divided (3), multiplied (1) and added up again (n).
fn average_error(count: usize) -> f64 {
    (2.0 * count as f64 + 7.0) * ROUNDING
}

/// Error of a normal under the cofactors of a matrix with entries of these magnitudes, each with a
/// relative error.
fn normal_error(magnitudes: &DMat3, entry_error: f64, given: &Bounded) -> DVec3 {
    let m = magnitudes;
    let sums = DMat3::from_cols(
        cross_magnitudes(m.y_axis, m.z_axis),
        cross_magnitudes(m.z_axis, m.x_axis),
        cross_magnitudes(m.x_axis, m.y_axis),
    );
    // Two factors, each with its error; a product and a difference; then three products, added.
    let error = (sums * given.value.abs() * (2.0 * entry_error + 6.0 * ROUNDING)
        + sums * given.error)
        * SECOND_ORDER;
    error + DVec3::splat(UNDERFLOW)
}

/// Error of a linear blend.
struct LinearBlendError {
    blend: LinearBlend,
    /// Weighted means of the magnitudes of all entries.
    magnitudes: DMat3,
    origin_magnitude: DVec3,
    /// Relative error of the blended entries.
    entry_error: f64,
}

impl LinearBlendError {
    fn of(joints: &[JointMatrix], weights: &[(usize, f64)]) -> Self {
        let (mut magnitudes, mut origin_magnitude) = (DMat3::ZERO, DVec3::ZERO);
        for &(joint, weight) in weights {
            let [x, y, z, translation] = weighted_columns(&joints[joint], weight).map(DVec3::abs);
            magnitudes += DMat3::from_cols(x, y, z);
            origin_magnitude += translation;
        }
        Self {
            blend: LinearBlend::of(joints, weights),
            magnitudes,
            origin_magnitude,
            entry_error: average_error(weights.len()),
        }
    }

    fn position(&self, given: &Bounded) -> DVec3 {
        let magnitude = self.magnitudes * given.value.abs() + self.origin_magnitude;
        // Four products, added.
        (magnitude * (self.entry_error + 5.0 * ROUNDING) + self.magnitudes * given.error)
            * SECOND_ORDER
            + DVec3::splat(UNDERFLOW)
    }

    fn normal(&self, given: &Bounded) -> Bounded {
        Bounded {
            value: self.blend.normal(given.value),
            error: normal_error(&self.magnitudes, self.entry_error, given),
        }
    }
}

/// Error of a dual quaternion blend.
struct DualQuaternionError {
    blend: DualQuaternionBlend,
    /// Weighted means of the magnitudes of the stretch's entries.
    magnitudes: DMat3,
    /// Relative error of the stretch's entries.
    entry_error: f64,
    /// Error of the rotation's components.
    rotation_error: f64,
    /// Error of the translation.
    translation_error: f64,
}

impl DualQuaternionError {
    fn of(joints: &[DualQuaternionJoint], weights: &[(usize, f64)]) -> Self {
        let blend = DualQuaternionBlend::of(joints, weights);
        let pivot = quaternion(joints[weights[0].0].real);
        let (mut magnitudes, mut dual_magnitude, mut is_ambiguous) = (DMat3::ZERO, 0.0, false);
        for &(joint, weight) in weights {
            let joint = &joints[joint];
            let [x, y, z] = weighted_rows(joint, weight);
            magnitudes += DMat3::from_cols(x.abs(), y.abs(), z.abs()).transpose();
            dual_magnitude += quaternion(joint.dual).length() * weight;
            // Half a turn from the first joint either way round is as short, and rounding chooses.
            is_ambiguous |=
                weight > 0.0 && pivot.dot(quaternion(joint.real)).abs() < 8.0 * ROUNDING;
        }
        let (length, dual_length, average) = (
            blend.length,
            blend.dual.length(),
            average_error(weights.len()),
        );
        // The sums, then the length (4) and the quotient (3); all components of four together at
        // most twice one.
        let rotation_error = 2.0 * average / length + 8.0 * ROUNDING;
        let dual_error = 2.0 * average * dual_magnitude / length + dual_length * rotation_error;
        let translation_error =
            2.0 * (2.0 * dual_error + 2.0 * dual_length * (rotation_error + 4.0 * ROUNDING));
        let is_unbounded = is_ambiguous || rotation_error > 0.25 || !rotation_error.is_finite();
        Self {
            blend,
            magnitudes,
            entry_error: average,
            rotation_error: if is_unbounded {
                f64::INFINITY
            } else {
                rotation_error
            },
            translation_error: if is_ambiguous {
                f64::INFINITY
            } else {
                translation_error
            },
        }
    }

    /// Error of a rotated vector of this length that is itself known to within `given`.
    fn rotated(&self, length: f64, given: f64) -> f64 {
        (given + length * (8.0 * self.rotation_error + 24.0 * ROUNDING)) * SECOND_ORDER
    }

    /// Error of the position that the blend makes of a given one.
    fn position(&self, given: &Bounded, blended: DVec3) -> DVec3 {
        let magnitude = self.magnitudes * given.value.abs();
        let stretched =
            magnitude * (self.entry_error + 4.0 * ROUNDING) + self.magnitudes * given.error;
        let rotated = self.rotated(
            self.blend.stretched(given.value).length(),
            stretched.length(),
        );
        DVec3::splat(
            rotated + self.translation_error + 2.0 * ROUNDING * blended.length() + UNDERFLOW,
        )
    }

    fn normal(&self, given: &Bounded) -> Bounded {
        let error = normal_error(&self.magnitudes, self.entry_error, given);
        let length = self.blend.stretched_normal(given.value).length();
        Bounded {
            value: self.blend.normal(given.value),
            error: DVec3::splat(self.rotated(length, error.length())),
        }
    }
}
