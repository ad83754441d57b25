//! Rigs as plain data: nodes, the skins whose joints they are, and the clips that animate them.

use glam::{DMat4, DQuat, DVec3};

use super::bounds::Bounds;

/// The skeletons and animations of a scene. Empty if nothing moves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// Every parent comes before its children.
    pub nodes: Vec<Node>,
    /// Skins, which instances refer to.
    pub skins: Vec<Skin>,
    /// Named animations.
    pub clips: Vec<Clip>,
    /// Keyframes. Several channels may share a sampler.
    pub samplers: Vec<Sampler>,
    /// Transforms relative to a node, of the instances of nodes that show their mesh many times.
    pub placements: Vec<DMat4>,
    /// Turns the nodes without a parent; none: they stand as the file has them.
    pub turn: Option<DMat4>,
    /// World-space box of sampled vertices in the rest pose and in the clips. Used to frame the
    /// camera; not a strict bound.
    pub motion_bounds: Bounds,
}

impl Rig {
    /// Returns true if nothing in the scene can move.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The index of the clip called `name`. `#2` is the clip at index 2, under any name.
    pub fn clip(&self, name: &str) -> Option<usize> {
        let by_index = || {
            name.strip_prefix('#')?
                .parse()
                .ok()
                .filter(|&index: &usize| index < self.clips.len())
        };
        self.clips
            .iter()
            .position(|clip| clip.name == name)
            .or_else(by_index)
    }
}

/// A node of the scene graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub name: String,
    /// Index of its parent in `Rig::nodes`.
    pub parent: Option<usize>,
    /// Transform relative to the parent in the rest pose.
    pub rest: LocalTransform,
    /// Morph weights of its mesh in the rest pose, one per morph target.
    pub weights: Vec<f32>,
}

/// A transform relative to the parent node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LocalTransform {
    /// A matrix from the file, which clips cannot animate.
    Matrix(DMat4),
    /// Separate translation, rotation and scale, which clips can animate.
    Trs(Trs),
}

#[derive(Clone, Copy, Debug, PartialEq)]
/// Translation, rotation and scale; a vertex is scaled first and translated last.
pub struct Trs {
    /// Meters.
    pub translation: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// Factor along each axis.
    pub scale: DVec3,
}

impl Default for Trs {
    fn default() -> Self {
        Self {
            translation: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            scale: DVec3::ONE,
        }
    }
}

impl Trs {
    /// The parts of a matrix that has no others: no shear, and no axis of length 0.
    pub fn of(matrix: &DMat4) -> Option<Self> {
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        let parts = Self {
            translation,
            rotation,
            scale,
        };
        let size = scale.abs().max_element();
        let is_same = LocalTransform::Trs(parts)
            .matrix()
            .abs_diff_eq(*matrix, 1e-4 * size.max(1e-30));
        (is_same && scale.is_finite() && rotation.is_normalized()).then_some(parts)
    }
}

impl LocalTransform {
    /// The transform as a matrix.
    pub fn matrix(&self) -> DMat4 {
        match self {
            Self::Matrix(matrix) => *matrix,
            Self::Trs(Trs {
                translation,
                rotation,
                scale,
            }) => DMat4::from_scale_rotation_translation(*scale, *rotation, *translation),
        }
    }
}

/// The joints that move the vertices of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    pub name: String,
    /// Node indices; the `JOINTS_n` attributes index this list.
    pub joints: Vec<usize>,
    /// The inverse bind matrix of each joint.
    pub joint_from_mesh: Vec<DMat4>,
}

/// A named animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    pub name: String,
    /// Time of the last keyframe of any channel, seconds.
    pub duration_s: f64,
    /// What it animates.
    pub channels: Vec<Channel>,
}

/// The animation of one property of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    /// Index into `Rig::nodes`.
    pub node: usize,
    pub property: Property,
    /// Index into `Rig::samplers`.
    pub sampler: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    Translation,
    Rotation,
    Scale,
    Weights,
}

impl Property {
    /// Its name in glTF.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Translation => "translation",
            Self::Rotation => "rotation",
            Self::Scale => "scale",
            Self::Weights => "weights",
        }
    }
}

/// How a value changes from one keyframe to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    Step,
    Linear,
    /// Cubic Hermite spline. Each keyframe has three values: in-tangent, value, out-tangent.
    Cubic,
}

/// Keyframes: times and values.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampler {
    pub interpolation: Interpolation,
    /// Keyframe times in seconds, strictly increasing, at least one.
    pub times: Vec<f32>,
    /// `components` numbers per keyframe, three times as many for a cubic spline. All finite.
    pub values: Vec<f32>,
    /// Numbers per value: 3, 4, or the number of morph targets.
    pub components: usize,
}
