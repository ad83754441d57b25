//! Rigs as plain data: nodes, clips that move them, skins that follow them, and shapes that meshes are mixed from.

use glam::{DMat4, DQuat, DVec3};

use super::{Accessor, Bounds};

/// What moves in a scene. Empty where nothing does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// Parents stand before their children.
    pub nodes: Vec<Node>,
    pub skins: Vec<Skin>,
    pub clips: Vec<Clip>,
    /// Key times and values, which channels may share.
    pub samplers: Vec<Sampler>,
    /// Box round samples of the scene at rest and in its clips: what a camera frames.
    pub reach: Bounds,
}

impl Rig {
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The clip called `name`; `#2` names the third one, whatever it is called.
    pub fn clip(&self, name: &str) -> Option<usize> {
        let by_place = || name.strip_prefix('#')?.parse().ok().filter(|&place: &usize| place < self.clips.len());
        self.clips.iter().position(|clip| clip.name == name).or_else(by_place)
    }
}

/// A place that others hang on.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub name: String,
    pub parent: Option<usize>,
    /// Where it stands in its parent while no clip moves it.
    pub rest: Local,
    /// Weights of the shapes of the mesh that it shows, at rest.
    pub weights: Vec<f32>,
}

/// Where a node stands in its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Local {
    /// As it is; no clip may move it.
    Matrix(DMat4),
    /// Scaled, then turned, then moved.
    Trs(Trs),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trs {
    pub translation: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    pub scale: DVec3,
}

impl Default for Trs {
    fn default() -> Self {
        Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
    }
}

impl Local {
    pub fn matrix(&self) -> DMat4 {
        match self {
            Self::Matrix(matrix) => *matrix,
            Self::Trs(Trs { translation, rotation, scale }) => DMat4::from_scale_rotation_translation(*scale, *rotation, *translation),
        }
    }
}

/// Joints that hold a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    pub name: String,
    /// Nodes, in the order in which vertices number them.
    pub joints: Vec<usize>,
    /// The inverse bind matrices: one per joint.
    pub joint_from_mesh: Vec<DMat4>,
}

/// A named movement.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    pub name: String,
    /// Time of the last key of any channel.
    pub duration_s: f64,
    pub channels: Vec<Channel>,
}

/// One property of one node, following a sampler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    pub node: usize,
    pub property: Property,
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
    pub const fn name(self) -> &'static str {
        match self {
            Self::Translation => "translation",
            Self::Rotation => "rotation",
            Self::Scale => "scale",
            Self::Weights => "weights",
        }
    }
}

/// How a value goes from one key to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    Step,
    Linear,
    /// Three values a key: the tangent that comes in, the value, the tangent that goes out.
    Cubic,
}

/// Keys over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampler {
    pub interpolation: Interpolation,
    /// Seconds, strictly rising, at least one.
    pub times: Vec<f32>,
    /// `lanes` numbers a key, three times as many for a cubic spline; all finite.
    pub values: Vec<f32>,
    pub components: usize,
}

/// How a mesh bends: whom its vertices follow, and what its shapes add to them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deformation {
    /// Sets of four joints with their weights; at most two, none for a mesh without a skin.
    pub influences: Vec<Influences>,
    pub morph_targets: Vec<Shape>,
    /// Box of the vertices that each joint holds with any weight; as many as the largest joint number asks for.
    pub joint_bounds: Vec<Bounds>,
}

impl Deformation {
    pub fn is_none(&self) -> bool {
        self.influences.is_empty() && self.morph_targets.is_empty()
    }
}

/// Four joints per vertex and their weights, in `Scene::vertex_bytes`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influences {
    pub joints: Accessor,
    /// Not negative; they need not sum to 1, and where all are 0 the first joint holds the vertex.
    pub weights: Accessor,
}

/// A morph target: what full weight adds to every vertex. In `Scene::vertex_bytes`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    pub positions: Option<Accessor>,
    pub normals: Option<Accessor>,
    /// Largest distance along any axis that it moves a vertex.
    pub reach: f64,
}
