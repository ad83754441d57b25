//! Poses: the transform of every instance, the joint transforms and the morph weights of a scene at
//! a time of its clips.
//!
//! A pose is a pure function of scene, clips and time, computed in f64 and rounded once. Renderers
//! and the oracle start from these rounded bits, and each deforms the vertices with its own code.

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3};

use super::{
    accessor::Accessor,
    bounds::Bounds,
    joint_transforms::{DualQuaternionJoint, JointTransforms, rounded_rows},
    model::{Instance, Primitive, Scene},
    quaternion::{slerp, unit},
    rig::{Interpolation, LocalTransform, Property, Rig, Sampler, Trs},
};
use crate::accuracy::Skinning;

/// Which clips are sampled at which time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Index into `Rig::clips`. `None`: the rest pose.
    pub clip: Option<usize>,
    /// Index of a second clip to blend with.
    pub other: Option<usize>,
    /// Weight of the second clip, 0 to 1.
    pub blend: f64,
    /// Time in both clips, seconds. Beyond the end of a clip it wraps around.
    pub time_s: f64,
    /// How joints are blended.
    pub skinning: Skinning,
}

/// A scene at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// World transform of every instance.
    instance_transforms: Vec<DMat4>,
    /// Deformation of every instance that has one.
    deforms: Vec<Option<Deform>>,
}

/// What deforms the vertices of an instance before its world transform is applied.
#[derive(Clone, Debug, PartialEq)]
pub struct Deform {
    /// The transforms of its joints. `None` without a skin.
    pub joint_transforms: Option<JointTransforms>,
    /// The weight of each of its morph targets.
    pub weights: Arc<[f32]>,
}

impl Pose {
    /// The pose of `scene` at the time of `motion`. The rig must not be empty.
    pub fn at(scene: &Scene, motion: &Motion) -> Self {
        let rig = &scene.rig;
        let state = State::of(rig, motion);
        let scene_from_node = state.node_transforms(rig);
        // The matrices of joints are rounded, so those of a skeleton that is far away count from it.
        let origin = |skin: usize| {
            const NEAR_M: f64 = 4096.0;
            let first = rig.skins[skin].joints.first();
            let place = first.map_or(DVec3::ZERO, |&node| scene_from_node[node].w_axis.truncate());
            match place.abs().max_element() {
                distance if distance < NEAR_M || !place.is_finite() => DVec3::ZERO,
                _ => place.round(),
            }
        };
        let joint_transforms = |skin: usize| {
            let from_scene = DMat4::from_translation(-origin(skin));
            let skin = &rig.skins[skin];
            let matrices = skin
                .joints
                .iter()
                .zip(&skin.joint_from_mesh)
                .map(|(&node, inverse)| from_scene * scene_from_node[node] * *inverse);
            match motion.skinning {
                Skinning::Linear => {
                    JointTransforms::Linear(matrices.map(|matrix| rounded_rows(&matrix)).collect())
                }
                Skinning::Dual => JointTransforms::Dual(
                    matrices
                        .map(|matrix| DualQuaternionJoint::of(&matrix))
                        .collect(),
                ),
            }
        };
        let joints_of_skins: Vec<JointTransforms> =
            (0..rig.skins.len()).map(joint_transforms).collect();
        let deform = |instance: &Instance| {
            let morph_targets = scene.primitives[instance.primitive]
                .deformation
                .morph_targets
                .len();
            let joint_transforms = instance.skin.map(|skin| joints_of_skins[skin].clone());
            let given = instance.node.map_or(&[][..], |node| &state.weights[node]);
            let weights: Arc<[f32]> = (0..morph_targets)
                .map(|morph_target| given.get(morph_target).copied().unwrap_or(0.0))
                .collect();
            (joint_transforms.is_some() || weights.iter().any(|&weight| weight != 0.0)).then_some(
                Deform {
                    joint_transforms,
                    weights,
                },
            )
        };
        let transform = |instance: &Instance| match (instance.skin, instance.node) {
            // The joints alone place a skinned mesh; its node is ignored (glTF 2.0, section
            // 3.7.3.2).
            (Some(skin), _) => DMat4::from_translation(origin(skin)),
            (None, Some(node)) => instance
                .placement
                .map_or(scene_from_node[node], |placement| {
                    scene_from_node[node] * rig.placements[placement]
                }),
            (None, None) => instance.world_from_object,
        };
        Self {
            instance_transforms: scene.instances.iter().map(transform).collect(),
            deforms: scene.instances.iter().map(deform).collect(),
        }
    }

    /// The rest pose. `None` for a scene without a rig, whose instance transforms are constant.
    pub fn at_rest(scene: &Scene) -> Option<Self> {
        (!scene.rig.is_empty()).then(|| Self::at(scene, &Motion::default()))
    }

    /// The transform of an instance, before the scene's spin.
    pub fn instance_transform(&self, instance: usize) -> DMat4 {
        // Instances that were added after the pose was computed (particle discs) do not move.
        self.instance_transforms
            .get(instance)
            .copied()
            .unwrap_or(DMat4::IDENTITY)
    }

    /// What deforms an instance, if anything does.
    pub fn deform(&self, instance: usize) -> Option<&Deform> {
        self.deforms.get(instance).and_then(Option::as_ref)
    }

    /// A box of all instances, before the scene's spin.
    pub fn bounds(&self, scene: &Scene) -> Bounds {
        self.bounds_of(scene, &scene.instances)
    }

    /// A box of `first`, the leading instances of `scene`.
    pub fn bounds_of(&self, scene: &Scene, first: &[Instance]) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for ((instance, transform), deform) in first
            .iter()
            .zip(&self.instance_transforms)
            .zip(&self.deforms)
        {
            let primitive = &scene.primitives[instance.primitive];
            let object = deform
                .as_ref()
                .map_or(primitive.bounds, |deform| deform.bounds(primitive));
            bounds.include_transformed(transform, &object, 0.0);
        }
        bounds
    }
}

/// The transform of every node of a rig.
pub fn scene_from_nodes(rig: &Rig, motion: &Motion) -> Vec<DMat4> {
    State::of(rig, motion).node_transforms(rig)
}

/// A box of `scene` in its rest pose and at eight times of each clip. Of large scenes only some
/// vertices and clips are sampled, so it is good for framing and not a strict bound.
pub fn motion_bounds(scene: &Scene) -> Bounds {
    const TIMES_PER_CLIP: usize = 8;
    const MAX_NODES: usize = 1_000_000;
    const MAX_VERTICES: usize = 2_000_000;
    // Of thousands of clips over thousands of nodes only the first are sampled.
    let most = (MAX_NODES
        / (TIMES_PER_CLIP * (scene.rig.nodes.len() + scene.instances.len()).max(1)))
    .max(1);
    let motion = |clip: usize, time: usize| Motion {
        clip: Some(clip),
        time_s: scene.rig.clips[clip].duration_s * (time as f64 + 0.5) / TIMES_PER_CLIP as f64,
        ..Motion::default()
    };
    let times = (0..scene.rig.clips.len().min(most))
        .flat_map(|clip| (0..TIMES_PER_CLIP).map(move |time| motion(clip, time)));
    let motions: Vec<Motion> = std::iter::once(Motion::default()).chain(times).collect();
    let stride = (scene.deformable_vertex_count() as usize * motions.len())
        .div_ceil(MAX_VERTICES)
        .max(1);
    let mut bounds = Bounds::EMPTY;
    for motion in &motions {
        let pose = Pose::at(scene, motion);
        for (index, instance) in scene.instances.iter().enumerate() {
            let (primitive, transform) = (
                &scene.primitives[instance.primitive],
                pose.instance_transform(index),
            );
            let Some(deform) = pose.deform(index) else {
                bounds.include_transformed(&transform, &primitive.bounds, 0.0);
                continue;
            };
            let vertices = (0..primitive.vertex_count()).step_by(stride);
            vertices.for_each(|vertex| {
                bounds
                    .include(transform.transform_point3(deform.position(scene, primitive, vertex)))
            });
        }
    }
    bounds
}

impl Deform {
    /// Returns true if every joint transform mirrors (has a negative determinant).
    pub fn mirrors(&self) -> bool {
        self.joint_transforms
            .as_ref()
            .is_some_and(|joint_transforms| {
                joint_transforms
                    .matrices()
                    .all(|matrix| matrix.determinant() < 0.0)
            })
    }

    /// A box of the deformed mesh. A linearly skinned vertex lies between the positions that its
    /// joints give it; by dual quaternions it may bulge beyond them by the radius of their box.
    pub fn bounds(&self, primitive: &Primitive) -> Bounds {
        let deformation = &primitive.deformation;
        let margin = self
            .weights
            .iter()
            .zip(&deformation.morph_targets)
            .map(|(weight, morph_target)| f64::from(weight.abs()) * morph_target.max_displacement)
            .sum();
        let mut bounds = Bounds::EMPTY;
        let Some(joint_transforms) = &self.joint_transforms else {
            bounds.include_transformed(&DMat4::IDENTITY, &primitive.bounds, margin);
            return bounds;
        };
        joint_transforms
            .matrices()
            .zip(&deformation.joint_bounds)
            .for_each(|(matrix, joint_bounds)| {
                bounds.include_transformed(&matrix, joint_bounds, margin)
            });
        if matches!(joint_transforms, JointTransforms::Dual(_)) && !bounds.is_empty() {
            let bulge = bounds.radius();
            (bounds.min, bounds.max) = (bounds.min - bulge, bounds.max + bulge);
        }
        bounds
    }

    /// The deformed position of a vertex: morph targets, then linear skinning. For estimates; the
    /// picture uses other code.
    pub fn position(&self, scene: &Scene, primitive: &Primitive, vertex: u32) -> DVec3 {
        let bytes = &scene.vertex_bytes;
        let vector = |accessor: &Accessor| {
            DVec3::from([0, 1, 2].map(|component| accessor.value(bytes, vertex, component)))
        };
        let morph_targets = self
            .weights
            .iter()
            .zip(&primitive.deformation.morph_targets)
            .filter_map(|(w, morph_target)| Some((w, morph_target.positions.as_ref()?)));
        let morphed = morph_targets.fold(
            vector(&primitive.positions),
            |position, (&weight, morph_target)| position + vector(morph_target) * f64::from(weight),
        );
        let Some(joint_transforms) = &self.joint_transforms else {
            return morphed;
        };
        let sets = primitive.deformation.influences.iter();
        let influences = sets.flat_map(|set| {
            [0, 1, 2, 3].map(|component| {
                (
                    set.joints.integer(bytes, vertex, component) as usize,
                    set.weights.value(bytes, vertex, component),
                )
            })
        });
        let (mut sum, mut total, mut first) = (DVec3::ZERO, 0.0, None);
        for (joint, weight) in influences {
            first.get_or_insert(joint);
            sum += joint_transforms.matrix(joint).transform_point3(morphed) * weight;
            total += weight;
        }
        if total > 0.0 {
            sum / total
        } else {
            first.map_or(morphed, |joint| {
                joint_transforms.matrix(joint).transform_point3(morphed)
            })
        }
    }
}

/// The animated values of all nodes.
struct State {
    locals: Vec<LocalTransform>,
    weights: Vec<Vec<f32>>,
}

impl State {
    fn of(rig: &Rig, motion: &Motion) -> Self {
        let mut state = Self::at(rig, motion.clip, motion.time_s);
        if let Some(other) = motion.other.filter(|_| motion.blend > 0.0) {
            state.blend(
                &Self::at(rig, Some(other), motion.time_s),
                motion.blend.min(1.0),
            );
        }
        state
    }

    /// Transforms of all nodes. Parents come before their children.
    fn node_transforms(&self, rig: &Rig) -> Vec<DMat4> {
        let mut scene_from_node: Vec<DMat4> = Vec::with_capacity(rig.nodes.len());
        for (node, local) in rig.nodes.iter().zip(&self.locals) {
            let parent = node.parent.map_or_else(
                || rig.turn.unwrap_or_default(),
                |parent| scene_from_node[parent],
            );
            scene_from_node.push(parent * local.matrix());
        }
        scene_from_node
    }

    fn at(rig: &Rig, clip: Option<usize>, time_s: f64) -> Self {
        let mut state = Self {
            locals: rig.nodes.iter().map(|node| node.rest).collect(),
            weights: rig.nodes.iter().map(|n| n.weights.clone()).collect(),
        };
        let Some(clip) = clip.and_then(|clip| rig.clips.get(clip)) else {
            return state;
        };
        let inside = (0.0..=clip.duration_s).contains(&time_s);
        let time_s = if inside || clip.duration_s <= 0.0 {
            time_s
        } else {
            time_s.rem_euclid(clip.duration_s)
        };
        for channel in &clip.channels {
            let sampler = &rig.samplers[channel.sampler];
            if channel.property == Property::Weights {
                let value = |component| sampler.value(component, time_s) as f32;
                state.weights[channel.node] = (0..sampler.components).map(value).collect();
                continue;
            }
            let LocalTransform::Trs(parts) = &mut state.locals[channel.node] else {
                continue;
            };
            let vector =
                || DVec3::from([0, 1, 2].map(|component| sampler.value(component, time_s)));
            match channel.property {
                Property::Translation => parts.translation = vector(),
                Property::Scale => parts.scale = vector(),
                Property::Rotation => parts.rotation = sampler.rotation(time_s),
                Property::Weights => unreachable!("weights were set above"),
            }
        }
        state
    }

    fn blend(&mut self, other: &Self, fraction: f64) {
        for (a, b) in self.locals.iter_mut().zip(&other.locals) {
            if let (LocalTransform::Trs(a), LocalTransform::Trs(b)) = (a, b) {
                *a = Trs {
                    translation: a.translation.lerp(b.translation, fraction),
                    rotation: slerp(a.rotation, b.rotation, fraction),
                    scale: a.scale.lerp(b.scale, fraction),
                };
            }
        }
        for (a, b) in self
            .weights
            .iter_mut()
            .flatten()
            .zip(other.weights.iter().flatten())
        {
            *a = (f64::from(*a) + (f64::from(*b) - f64::from(*a)) * fraction) as f32;
        }
    }
}

impl Sampler {
    /// The keyframe at or before `time_s`, and the fraction of the way to the next one with the
    /// seconds between them. Outside the keyframes only the nearest one.
    fn segment(&self, time_s: f64) -> (usize, Option<(f64, f64)>) {
        let next = self
            .times
            .partition_point(|&time| f64::from(time) <= time_s);
        if next == 0 || next == self.times.len() {
            return (next.saturating_sub(1), None);
        }
        let [from, to] = [next - 1, next].map(|key| f64::from(self.times[key]));
        (next - 1, Some(((time_s - from) / (to - from), to - from)))
    }

    /// A number of a keyframe: `part` 0 is the in-tangent, 1 the value, 2 the out-tangent.
    fn number(&self, key: usize, part: usize, component: usize) -> f64 {
        let at = if self.interpolation == Interpolation::Cubic {
            3 * key + part
        } else {
            key
        };
        self.values[at * self.components + component].into()
    }

    /// One component at `time_s` (glTF 2.0, appendix C).
    pub fn value(&self, component: usize, time_s: f64) -> f64 {
        let (key, segment) = self.segment(time_s);
        let a = self.number(key, 1, component);
        let Some((t, seconds)) = segment else {
            return a;
        };
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear => a + (self.number(key + 1, 1, component) - a) * t,
            Interpolation::Cubic => {
                let (out, into, b) = (
                    self.number(key, 2, component),
                    self.number(key + 1, 0, component),
                    self.number(key + 1, 1, component),
                );
                let (t2, t3) = (t * t, t * t * t);
                (2.0 * t3 - 3.0 * t2 + 1.0) * a
                    + seconds * (t3 - 2.0 * t2 + t) * out
                    + (3.0 * t2 - 2.0 * t3) * b
                    + seconds * (t3 - t2) * into
            }
        }
    }

    /// A rotation at `time_s`. Linear interpolation is spherical, along the shorter arc.
    pub fn rotation(&self, time_s: f64) -> DQuat {
        let (key, segment) = self.segment(time_s);
        match (self.interpolation, segment) {
            (Interpolation::Linear, Some((fraction, _))) => {
                let [a, b] = [key, key + 1]
                    .map(|key| unit([0, 1, 2, 3].map(|component| self.number(key, 1, component))));
                slerp(a, b, fraction)
            }
            _ => unit([0, 1, 2, 3].map(|component| self.value(component, time_s))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampler(interpolation: Interpolation, components: usize, values: &[f32]) -> Sampler {
        Sampler {
            interpolation,
            times: vec![1.0, 3.0],
            values: values.into(),
            components,
        }
    }

    #[test]
    fn every_interpolation_meets_its_keys_and_holds_outside_them() {
        let cubic = [9.0, 2.0, 0.5, -1.0, 6.0, 9.0];
        for (interpolation, values, middle) in [
            (Interpolation::Step, &[2.0, 6.0][..], 2.0),
            (Interpolation::Linear, &[2.0, 6.0], 4.0),
            // Half way: (2 + 6) / 2 + 2 s (0.5 - (-1)) / 8.
            (Interpolation::Cubic, &cubic, 4.375),
        ] {
            let sampler = sampler(interpolation, 1, values);
            let at = |time_s| sampler.value(0, time_s);
            assert_eq!(
                [at(-1.0), at(1.0), at(2.0), at(3.0), at(9.0)],
                [2.0, 2.0, middle, 6.0, 6.0],
                "{interpolation:?}"
            );
        }
    }

    #[test]
    fn a_rotation_goes_the_short_way_at_one_speed_and_stays_a_unit() {
        let (sin, cos) = libm::sincos(0.6);
        // The same rotation as (sin, 0, 0, cos), named by its opposite, and three times as long.
        let turn = [
            0.0,
            0.0,
            0.0,
            1.0,
            -3.0 * sin as f32,
            0.0,
            0.0,
            -3.0 * cos as f32,
        ];
        let sampler = sampler(Interpolation::Linear, 4, &turn);
        for step in 0..=8 {
            let fraction = f64::from(step) / 8.0;
            let q = sampler.rotation(1.0 + 2.0 * fraction);
            let (sin, cos) = libm::sincos(0.6 * fraction);
            assert!(
                (q.x.abs() - sin).abs() < 1e-7
                    && (q.w.abs() - cos).abs() < 1e-7
                    && q.x * q.w >= 0.0,
                "{fraction}: {q}"
            );
            assert!((q.length_squared() - 1.0).abs() < 1e-14);
        }
    }
}
