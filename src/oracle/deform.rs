//! Bending in f64: shapes first, then joints (glTF 2.0, sections 3.7.2.2 and 3.7.3), and how far a float renderer may be
//! from that.

use glam::{DMat3, DQuat, DVec3};
use rayon::prelude::*;

use super::project::gated_lane;
use crate::{
    effects::hooks::ROUNDING,
    frame::vertex_flags,
    measure::ErrorReport,
    scene::{
        Accessor, ComponentType, Primitive, Scene,
        deformation::MorphTarget,
        draw::{Draw, MAX_MAGNITUDE},
        joint_transforms::{DualQuaternionJoint, JointMatrix, JointTransforms},
        pose::Deform,
        view::View,
    },
};

/// A value with the largest error that f32 arithmetic of any order, rounding and fusion may make of it, per axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bounded {
    pub value: DVec3,
    pub error: DVec3,
}

/// Every vertex of a draw that bends, as floats: what an adapter should have kept.
pub(super) fn vertices(scene: &Scene, draw: &Draw) -> Vec<[f32; 6]> {
    let count = if draw.deform.is_some() { scene.primitives[draw.primitive].vertex_count() } else { 0 };
    let vertex = |vertex| {
        let (p, n) = (place(scene, draw, vertex).unwrap_or(DVec3::INFINITY), normal(scene, draw, vertex).unwrap_or(DVec3::INFINITY));
        [p.x, p.y, p.z, n.x, n.y, n.z].map(|lane| lane as f32)
    };
    (0..count).into_par_iter().map(vertex).collect()
}

/// Volume that the bent meshes of a picture enclose, cubic metres: what skinning may lose. Of a mesh with holes, whatever the
/// divergence theorem makes of it.
pub fn volume(scene: &Scene, draws: &[Draw]) -> f64 {
    let of_draw = |draw: &Draw| {
        let primitive = &scene.primitives[draw.primitive];
        let corner = |vertex| place(scene, draw, vertex).unwrap_or(DVec3::ZERO);
        let triangle = |triangle| {
            let [a, b, c] = primitive.corners(scene, triangle).map(corner);
            a.dot(b.cross(c)) / 6.0
        };
        (0..primitive.triangle_count()).map(triangle).sum::<f64>()
    };
    draws.iter().filter(|draw| draw.deform.is_some()).map(of_draw).sum()
}

/// Holds the vertices that an adapter bent, in draw order, against the reference and its bound.
///
/// # Panics
/// When their number is not that of the vertices which bend.
pub(super) fn judge(accuracy: &mut ErrorReport, scene: &Scene, draws: &[Draw], view: &View, deformed: &[[f32; 6]]) {
    let of_draw = |draw: &Draw| if draw.deform.is_some() { scene.primitives[draw.primitive].vertex_count() } else { 0 };
    let total: usize = draws.iter().map(|draw| of_draw(draw) as usize).sum();
    assert_eq!(deformed.len(), total, "the bent vertices are of another scene");
    let mut first = 0;
    for draw in draws.iter().filter(|draw| draw.deform.is_some()) {
        let given = &deformed[first..first + of_draw(draw) as usize];
        first += given.len();
        let judged: Vec<Judged> = given.par_iter().enumerate().map(|(i, given)| judged(scene, draw, view, i as u32, given)).collect();
        accuracy.deformed_vertices += judged.len() as u64;
        for Judged { is_outside, ulp, px } in judged {
            accuracy.deformed_outside_bound += u64::from(is_outside);
            accuracy.max_deform_ulp = accuracy.max_deform_ulp.max(ulp);
            accuracy.max_deform_px = accuracy.max_deform_px.max(px);
        }
    }
}

#[derive(Default)]
struct Judged {
    is_outside: bool,
    ulp: f64,
    px: f64,
}

fn judged(scene: &Scene, draw: &Draw, view: &View, vertex: u32, given: &[f32; 6]) -> Judged {
    let [px, py, pz, nx, ny, nz] = given.map(f64::from);
    let (at, turned) = (DVec3::new(px, py, pz), DVec3::new(nx, ny, nz));
    // What was refused stays refused, whatever its bits.
    let Ok(reference) = bounded_place(scene, draw, vertex) else {
        return Judged { is_outside: at.abs().max_element() < MAX_MAGNITUDE, ..Judged::default() };
    };
    let is_near = |given: DVec3, reference: &Bounded| {
        let error_bound = reference.error + reference.value.abs() * ROUNDING + DVec3::splat(f64::from(f32::MIN_POSITIVE));
        (given - reference.value).abs().cmple(error_bound).all()
    };
    let normal = bounded_normal(scene, draw, vertex);
    let is_outside = !is_near(at, &reference) || normal.is_some_and(|normal| !is_near(turned, &normal));
    let largest = reference.value.abs().max_element().max(f64::from(f32::MIN_POSITIVE));
    let spacing = f64::from(f32::EPSILON) * libm::exp2(libm::floor(libm::log2(largest)));
    let screen = |p: DVec3| {
        let p = p - draw.origin();
        let row = |r: usize| {
            let m = |column: usize| f64::from(draw.clip_from_object[column][r]);
            m(0) * p.x + m(1) * p.y + m(2) * p.z + m(3)
        };
        let (z, w) = (row(2), row(3));
        (z <= w && w > 0.0).then(|| [row(0) / w * 0.5 * f64::from(view.width), row(1) / w * 0.5 * f64::from(view.height)])
    };
    let px = screen(at).zip(screen(reference.value)).map_or(0.0, |(a, b)| libm::hypot(a[0] - b[0], a[1] - b[1]));
    Judged { is_outside, ulp: (at - reference.value).abs().max_element() / spacing, px }
}

/// Position of a vertex of `draw` in object space, or the flags of all lanes that were refused.
pub(super) fn place(scene: &Scene, draw: &Draw, vertex: u32) -> Result<DVec3, u32> {
    bounded_place(scene, draw, vertex).map(|place| place.value)
}

/// Normal in object space, of any length; none when a lane is refused. A bent one is a unit vector, or zero.
pub(super) fn normal(scene: &Scene, draw: &Draw, vertex: u32) -> Option<DVec3> {
    bounded_normal(scene, draw, vertex).map(|normal| normal.value)
}

pub(super) fn bounded_place(scene: &Scene, draw: &Draw, vertex: u32) -> Result<Bounded, u32> {
    let primitive = &scene.primitives[draw.primitive];
    let lanes = [0, 1, 2].map(|lane| gated_lane(&scene.vertex_bytes, &primitive.positions, vertex, lane));
    let stored = match lanes {
        [Ok(x), Ok(y), Ok(z)] => DVec3::new(x, y, z),
        refused => return Err(refused.iter().filter_map(|lane| lane.err()).fold(0, |all, flag| all | flag)),
    };
    let Some(deform) = &draw.deform else {
        return Ok(Bounded { value: stored, error: stored.abs() * pull_error(&primitive.positions) });
    };
    let mixed = mixed(scene, primitive, deform, vertex, stored, &primitive.positions, |shape| shape.positions.as_ref());
    let deformed = match &deform.joint_transforms {
        None => mixed,
        Some(JointTransforms::Linear(joints)) => Blend::of(joints, &influences(scene, primitive, vertex)).place(&mixed),
        Some(JointTransforms::Dual(joints)) => Turn::of(joints, &influences(scene, primitive, vertex)).place(&mixed),
    };
    if deformed.value.abs().max_element() >= MAX_MAGNITUDE { Err(vertex_flags::OUT_OF_RANGE) } else { Ok(deformed) }
}

pub(super) fn bounded_normal(scene: &Scene, draw: &Draw, vertex: u32) -> Option<Bounded> {
    let primitive = &scene.primitives[draw.primitive];
    let lane = |lane: u32| gated_lane(&scene.vertex_bytes, &primitive.normals, vertex, lane).ok();
    let stored = DVec3::new(lane(0)?, lane(1)?, lane(2)?);
    let Some(deform) = &draw.deform else {
        return Some(Bounded { value: stored, error: stored.abs() * pull_error(&primitive.normals) });
    };
    let mixed = mixed(scene, primitive, deform, vertex, stored, &primitive.normals, |shape| shape.normals.as_ref());
    let deformed = match &deform.joint_transforms {
        None => mixed,
        Some(JointTransforms::Linear(joints)) => Blend::of(joints, &influences(scene, primitive, vertex)).normal(&mixed),
        Some(JointTransforms::Dual(joints)) => Turn::of(joints, &influences(scene, primitive, vertex)).normal(&mixed),
    };
    Some(unit(&deformed))
}

/// Its direction; zero where it has none.
fn unit(vector: &Bounded) -> Bounded {
    let (length, error) = (vector.value.length(), vector.error.length());
    let error_bound = if error < 0.5 * length { error / (length - error) + 8.0 * ROUNDING } else { 2.0 };
    Bounded { value: vector.value.try_normalize().unwrap_or(DVec3::ZERO), error: DVec3::splat(error_bound) }
}

/// Relative error of a lane as it is pulled: normalized integers are divided.
fn pull_error(accessor: &Accessor) -> f64 {
    if accessor.normalized && accessor.component_type != ComponentType::F32 { 3.0 * ROUNDING } else { 0.0 }
}

/// A stored vector with what the shapes add to it.
fn mixed(
    scene: &Scene,
    primitive: &Primitive,
    deform: &Deform,
    vertex: u32,
    stored: DVec3,
    accessor: &Accessor,
    lane_of: impl Fn(&MorphTarget) -> Option<&Accessor>,
) -> Bounded {
    let (mut value, mut magnitude) = (stored, stored.abs() * (1.0 + pull_error(accessor)));
    let (mut pulled, mut terms) = (stored.abs() * pull_error(accessor), 0);
    for (&weight, shape) in deform.weights.iter().zip(&primitive.deformation.morph_targets) {
        let Some(accessor) = lane_of(shape).filter(|_| weight != 0.0) else { continue };
        let lanes = [0, 1, 2].map(|lane| gated_lane(&scene.vertex_bytes, accessor, vertex, lane));
        // A lane that is refused adds nothing to any.
        let [Ok(x), Ok(y), Ok(z)] = lanes else { continue };
        let added = DVec3::new(x, y, z) * f64::from(weight);
        value += added;
        magnitude += added.abs();
        pulled += added.abs() * pull_error(accessor);
        terms += 1;
    }
    Bounded { value, error: pulled + magnitude * (f64::from(terms + 1) * ROUNDING * f64::from(u8::from(terms > 0))) }
}

/// Joints of a vertex with their shares, which sum to 1.
struct Influenced {
    shares: Vec<(usize, f64)>,
    /// Relative error of anything that is averaged by these shares.
    error: f64,
}

fn influences(scene: &Scene, primitive: &Primitive, vertex: u32) -> Influenced {
    let bytes = &scene.vertex_bytes;
    let sets = primitive.deformation.influences.iter();
    let mut shares: Vec<(usize, f64)> = sets
        .flat_map(|set| [0, 1, 2, 3].map(|lane| (set.joints.integer(bytes, vertex, lane) as usize, set.weights.value(bytes, vertex, lane))))
        .collect();
    let sum: f64 = shares.iter().map(|(_, weight)| weight).sum();
    for (place, (_, weight)) in shares.iter_mut().enumerate() {
        // Whom no weight holds, the first joint does.
        *weight = if sum > 0.0 { *weight / sum } else { f64::from(u8::from(place == 0)) };
    }
    // Each weight is pulled (3), all are added (n), divided (3), multiplied (1) and added up again (n).
    let error = (2.0 * shares.len() as f64 + 7.0) * ROUNDING;
    Influenced { shares, error }
}

/// Linear blend: the mean of the joints' matrices.
struct Blend {
    matrix: DMat3,
    origin: DVec3,
    /// The same of the magnitudes of all entries.
    magnitudes: DMat3,
    origin_magnitude: DVec3,
    error: f64,
}

impl Blend {
    fn of(joints: &[JointMatrix], influenced: &Influenced) -> Self {
        let mut blend = Self {
            matrix: DMat3::ZERO,
            origin: DVec3::ZERO,
            magnitudes: DMat3::ZERO,
            origin_magnitude: DVec3::ZERO,
            error: influenced.error,
        };
        for &(joint, share) in &influenced.shares {
            let column = |c: usize| DVec3::new(joints[joint][0][c].into(), joints[joint][1][c].into(), joints[joint][2][c].into()) * share;
            blend.matrix += DMat3::from_cols(column(0), column(1), column(2));
            blend.origin += column(3);
            blend.magnitudes += DMat3::from_cols(column(0).abs(), column(1).abs(), column(2).abs());
            blend.origin_magnitude += column(3).abs();
        }
        blend
    }

    fn place(&self, given: &Bounded) -> Bounded {
        let magnitude = self.magnitudes * given.value.abs() + self.origin_magnitude;
        // Four products, added; a sixteenth for what is of second order.
        let error = (magnitude * (self.error + 5.0 * ROUNDING) + self.magnitudes * given.error) * (17.0 / 16.0);
        Bounded { value: self.matrix * given.value + self.origin, error: error + DVec3::splat(4.0 * f64::from(f32::MIN_POSITIVE)) }
    }

    fn normal(&self, given: &Bounded) -> Bounded {
        deformed_normal(&self.matrix, &self.magnitudes, self.error, given)
    }
}

/// A normal under the cofactors of a matrix whose entries err by `error` times their magnitudes.
fn deformed_normal(matrix: &DMat3, magnitudes: &DMat3, error: f64, given: &Bounded) -> Bounded {
    let cofactors = |m: &DMat3| DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let m = magnitudes;
    let crossed = |a: DVec3, b: DVec3| DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x);
    let sums = DMat3::from_cols(crossed(m.y_axis, m.z_axis), crossed(m.z_axis, m.x_axis), crossed(m.x_axis, m.y_axis));
    // Two factors, each with its error; product and difference; then three products, added.
    let error = (sums * given.value.abs() * (2.0 * error + 6.0 * ROUNDING) + sums * given.error) * (17.0 / 16.0);
    Bounded { value: cofactors(matrix) * given.value, error: error + DVec3::splat(4.0 * f64::from(f32::MIN_POSITIVE)) }
}

/// Dual quaternion blend (Kavan et al. 2007): the joints' stretches are averaged as matrices, their rigid motions as dual
/// quaternions, which keep lengths.
struct Turn {
    stretch: DMat3,
    magnitudes: DMat3,
    rotation: DQuat,
    shift: DVec3,
    /// Of the stretch's entries, relative; of the rotation's components; of the shift.
    error: f64,
    rotation_error: f64,
    shift_error: f64,
}

impl Turn {
    fn of(joints: &[DualQuaternionJoint], influenced: &Influenced) -> Self {
        let quaternion = |q: [f32; 4]| DQuat::from_array(q.map(f64::from));
        let pivot = quaternion(joints[influenced.shares[0].0].real);
        let zero = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        let (mut real, mut dual, mut dual_magnitude, mut is_torn) = (zero, zero, 0.0, false);
        let (mut stretch, mut magnitudes) = (DMat3::ZERO, DMat3::ZERO);
        for &(joint, share) in &influenced.shares {
            let held = &joints[joint];
            let rows = held.stretch.map(|row| DVec3::new(row[0].into(), row[1].into(), row[2].into()) * share);
            stretch += DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
            magnitudes += DMat3::from_cols(rows[0].abs(), rows[1].abs(), rows[2].abs()).transpose();
            let along = pivot.dot(quaternion(held.real));
            // Half a turn apart, either way round is as short, and rounding chooses.
            is_torn |= share > 0.0 && along.abs() < 8.0 * ROUNDING;
            let signed = if along < 0.0 { -share } else { share };
            real += quaternion(held.real) * signed;
            dual += quaternion(held.dual) * signed;
            dual_magnitude += quaternion(held.dual).length() * share;
        }
        let length = real.length();
        let (rotation, moved) = (real * (1.0 / length), dual * (1.0 / length));
        let (r, d) = (DVec3::new(rotation.x, rotation.y, rotation.z), DVec3::new(moved.x, moved.y, moved.z));
        let shift = 2.0 * (rotation.w * d - moved.w * r + r.cross(d));
        // The sums, then the length (4) and the quotient (3); all components of four together at most twice one.
        let rotation_error = 2.0 * influenced.error / length + 8.0 * ROUNDING;
        let dual_error = 2.0 * influenced.error * dual_magnitude / length + moved.length() * rotation_error;
        let shift_error = 2.0 * (2.0 * dual_error + 2.0 * moved.length() * (rotation_error + 4.0 * ROUNDING));
        let torn = |error: f64| if is_torn || error > 0.25 || !error.is_finite() { f64::INFINITY } else { error };
        Self {
            stretch,
            magnitudes,
            rotation,
            shift,
            error: influenced.error,
            rotation_error: torn(rotation_error),
            shift_error: if is_torn { f64::INFINITY } else { shift_error },
        }
    }

    fn turned(&self, v: DVec3) -> DVec3 {
        let r = DVec3::new(self.rotation.x, self.rotation.y, self.rotation.z);
        v + 2.0 * r.cross(r.cross(v) + self.rotation.w * v)
    }

    /// Error of a turned vector of a length, itself known to within `given`.
    fn turn_error(&self, length: f64, given: f64) -> f64 {
        (given + length * (8.0 * self.rotation_error + 24.0 * ROUNDING)) * (17.0 / 16.0)
    }

    fn place(&self, given: &Bounded) -> Bounded {
        let stretched = self.stretch * given.value;
        let magnitude = self.magnitudes * given.value.abs();
        let error = magnitude * (self.error + 4.0 * ROUNDING) + self.magnitudes * given.error;
        let value = self.turned(stretched) + self.shift;
        let error = self.turn_error(stretched.length(), error.length()) + self.shift_error + 2.0 * ROUNDING * value.length();
        Bounded { value, error: DVec3::splat(error + 4.0 * f64::from(f32::MIN_POSITIVE)) }
    }

    fn normal(&self, given: &Bounded) -> Bounded {
        let stretched = deformed_normal(&self.stretch, &self.magnitudes, self.error, given);
        let error = self.turn_error(stretched.value.length(), stretched.error.length());
        Bounded { value: self.turned(stretched.value), error: DVec3::splat(error) }
    }
}
