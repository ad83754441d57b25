//! Deformation: the morph targets of primitives, and the joints and weights of skinned ones.

use gltf::json::{self, mesh::Semantic, validation::Checked};

use super::{
    LoadError, limits,
    meshes::{FLOAT, Loader, check_finite},
    skin,
};
use crate::scene::{
    Accessor, Component, Primitive,
    rig::{Influences, Rig, Shape},
};

/// Component types of displacements under KHR_mesh_quantization.
const SHORT: &[(Component, bool)] =
    &[(Component::F32, false), (Component::I8, false), (Component::I8, true), (Component::I16, false), (Component::I16, true)];

/// Returns true if the file has animations, skinned meshes or morph targets.
pub fn moves(root: &json::Root) -> bool {
    let has_targets = |primitive: &json::mesh::Primitive| primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty());
    let is_skinned = root.nodes.iter().any(|node| node.skin.is_some() && node.mesh.is_some());
    !root.animations.is_empty() || is_skinned || root.meshes.iter().flat_map(|mesh| &mesh.primitives).any(has_targets)
}

/// Morph weights of a node in the rest pose: its own, else those of its mesh, else zeros.
pub fn weights(root: &json::Root, node: &json::Node) -> Result<Vec<f32>, LoadError> {
    let Some(mesh) = node.mesh.map(|mesh| &root.meshes[mesh.value()]) else { return Ok(Vec::new()) };
    let counts = mesh.primitives.iter().map(|primitive| primitive.targets.as_ref().map_or(0, Vec::len));
    let morph_targets = counts.clone().max().unwrap_or(0);
    if morph_targets > limits::SHAPES {
        return Err(LoadError::new(format!("its mesh has {morph_targets} morph targets; allowed: at most {}", limits::SHAPES)));
    }
    if let Some(fewer) = counts.clone().find(|&count| count != morph_targets) {
        return Err(LoadError::new(format!("the primitives of its mesh have {fewer} and {morph_targets} morph targets; all must have the same number")));
    }
    let given = node.weights.as_ref().or(mesh.weights.as_ref()).filter(|weights| !weights.is_empty());
    match given {
        None => Ok(vec![0.0; morph_targets]),
        Some(weights) if weights.len() != morph_targets => {
            Err(LoadError::new(format!("it has {} weights for {morph_targets} morph targets; both numbers must be equal", weights.len())))
        }
        Some(weights) => match weights.iter().find(|weight| !weight.is_finite()) {
            Some(weight) => Err(LoadError::new(format!("it has the morph weight {weight}; weights must be finite"))),
            None => Ok(weights.clone()),
        },
    }
}

impl Loader<'_> {
    /// The morph targets of a primitive. Errors begin as those of attributes do.
    pub fn morph_targets(&mut self, about: &json::mesh::Primitive, count: u32) -> Result<Vec<Shape>, LoadError> {
        let targets = about.targets.iter().flatten().enumerate();
        targets.map(|(index, target)| self.shape(target, count).map_err(|e| LoadError(format!(" target {index} {}", e.0)))).collect()
    }

    fn shape(&mut self, target: &json::mesh::MorphTarget, count: u32) -> Result<Shape, LoadError> {
        let mut read = |index: Option<json::Index<json::Accessor>>, what: &str| {
            let Some(index) = index else { return Ok(None) };
            let kinds = if self.is_quantized { SHORT } else { FLOAT };
            let accessor = self.attribute(index.value(), count, &[3], kinds).map_err(|error| error.within(what))?;
            check_finite(&self.scene, &accessor).map_err(|error| error.within(what))?;
            Ok(Some(accessor))
        };
        let (positions, normals) = (read(target.positions, "POSITION")?, read(target.normals, "NORMAL")?);
        let reach = positions.map_or(0.0, |accessor| {
            let value = |vertex| [0, 1, 2].map(|lane| accessor.value(&self.scene.vertex_bytes, vertex, lane).abs());
            (0..count).flat_map(value).fold(0.0, f64::max)
        });
        Ok(Shape { positions, normals, reach })
    }

    /// Reads the joints and weights of a primitive that is placed by `skin`, unless that was done before.
    pub fn hold(&mut self, primitive: usize, skin: usize, rig: &Rig) -> Result<(), LoadError> {
        let joint_count = rig.skins[skin].joints.len();
        let Primitive { name, positions, deformation, .. } = self.scene.primitives[primitive].clone();
        if deformation.influences.is_empty() {
            let sets = self.influences(primitive, positions.count)?;
            let held = skin::held(&self.scene, &sets, &positions, joint_count)?;
            let what = [
                (held.weightless, "have only weights of 0; they follow their first joint"),
                (held.uneven, "have weights that do not sum to 1; they are normalized"),
            ];
            what.iter().filter(|(count, _)| *count > 0).for_each(|(count, what)| self.note(format!("{name}: {count} vertices {what}")));
            let deformation = &mut self.scene.primitives[primitive].deformation;
            (deformation.influences, deformation.joint_bounds) = (sets, held.bounds);
        } else if deformation.joint_bounds.len() > joint_count {
            return Err(
                LoadError::new(format!("refers to joint {}, but the skin has {joint_count} joints", deformation.joint_bounds.len() - 1)).within("JOINTS_0")
            );
        }
        Ok(())
    }

    fn influences(&mut self, primitive: usize, count: u32) -> Result<Vec<Influences>, LoadError> {
        let about = self.origins[primitive];
        let find = |semantic: Semantic| about.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value());
        let mut sets = Vec::new();
        for set in 0..3 {
            let (joints, weights) = match (find(Semantic::Joints(set)), find(Semantic::Weights(set))) {
                (Some(joints), Some(weights)) => (joints, weights),
                (None, None) if set > 0 => break,
                _ => return Err(LoadError::new(format!("it has a skin, but lacks JOINTS_{set} or WEIGHTS_{set}; export both"))),
            };
            if set == 2 {
                let name = self.scene.primitives[primitive].name.clone();
                self.note(format!("{name}: only the first 8 joints per vertex are used"));
                break;
            }
            let mut take = |index: usize, what: &str| -> Result<Accessor, LoadError> {
                let what = format!("{what}_{set}");
                let accessor = self.buffers.layout(index).map_err(|error| error.within(&what))?.accessor;
                skin::check_types(&accessor, &what, count)?;
                self.take_over(index).map_err(|error| error.within(&what))
            };
            sets.push(Influences { joints: take(joints, "JOINTS")?, weights: take(weights, "WEIGHTS")? });
        }
        Ok(sets)
    }
}
