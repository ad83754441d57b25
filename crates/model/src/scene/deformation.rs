//! What deforms a mesh: joint influences and morph targets, as plain data.

use super::{accessor::Accessor, bounds::Bounds};

/// What deforms a mesh: joint influences and morph targets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deformation {
    /// Sets of four joints and weights per vertex: none without a skin, at most two.
    pub influences: Vec<Influences>,
    /// Weighted by the node that shows the mesh.
    pub morph_targets: Vec<MorphTarget>,
    /// For each joint, the object-space box of the vertices that it influences (a weight above 0).
    /// As long as the largest joint index requires.
    pub joint_bounds: Vec<Bounds>,
}

impl Deformation {
    /// Returns true if the mesh cannot deform.
    pub fn is_none(&self) -> bool {
        self.influences.is_empty() && self.morph_targets.is_empty()
    }
}

/// Four joint indices and four weights per vertex, in `Scene::vertex_bytes`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Influences {
    /// Indices into `Skin::joints`.
    pub joints: Accessor,
    /// Not negative, of any sum. A vertex whose weights are all 0 follows its first joint.
    pub weights: Accessor,
}

/// A morph target: the displacements that a weight of 1 adds to every vertex. In
/// `Scene::vertex_bytes`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MorphTarget {
    /// Displacements of positions, three components.
    pub positions: Option<Accessor>,
    /// Changes of normals, three components.
    pub normals: Option<Accessor>,
    /// The largest displacement of any vertex along any axis at a weight of 1, in object space.
    pub max_displacement: f64,
}
