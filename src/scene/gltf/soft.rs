//! Deformation: morph targets of primitives, and the joints and weights of those that a skin holds.

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

/// What KHR_mesh_quantization adds for what a morph target adds.
const SHORT: &[(Component, bool)] =
    &[(Component::F32, false), (Component::I8, false), (Component::I8, true), (Component::I16, false), (Component::I16, true)];

/// Does the file hold anything that moves?
pub fn moves(root: &json::Root) -> bool {
    let has_targets = |primitive: &json::mesh::Primitive| primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty());
    let is_skinned = root.nodes.iter().any(|node| node.skin.is_some() && node.mesh.is_some());
    !root.animations.is_empty() || is_skinned || root.meshes.iter().flat_map(|mesh| &mesh.primitives).any(has_targets)
}

/// Weights of the shapes of a node's mesh at rest: the node's own, else the mesh's, else zeros.
pub fn weights(root: &json::Root, node: &json::Node) -> Result<Vec<f32>, LoadError> {
    let Some(mesh) = node.mesh.map(|mesh| &root.meshes[mesh.value()]) else { return Ok(Vec::new()) };
    let counts = mesh.primitives.iter().map(|primitive| primitive.targets.as_ref().map_or(0, Vec::len));
    let morph_targets = counts.clone().max().unwrap_or(0);
    if morph_targets > limits::SHAPES {
        return Err(LoadError::new(format!("its mesh has {morph_targets} morph targets; at most {} are read", limits::SHAPES)));
    }
    if let Some(fewer) = counts.clone().find(|&count| count != morph_targets) {
        return Err(LoadError::new(format!("primitives of its mesh have {fewer} and {morph_targets} morph targets")));
    }
    let given = node.weights.as_ref().or(mesh.weights.as_ref()).filter(|weights| !weights.is_empty());
    match given {
        None => Ok(vec![0.0; morph_targets]),
        Some(weights) if weights.len() != morph_targets => {
            Err(LoadError::new(format!("has {} weights for {morph_targets} morph targets", weights.len())))
        }
        Some(weights) => match weights.iter().find(|weight| !weight.is_finite()) {
            Some(weight) => Err(LoadError::new(format!("has the morph weight {weight}"))),
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

    /// Makes sure that a primitive can follow the joints of a skin.
    pub fn hold(&mut self, primitive: usize, skin: usize, rig: &Rig) -> Result<(), LoadError> {
        let joint_transforms = rig.skins[skin].joints.len();
        let Primitive { name, positions, deformation, .. } = self.scene.primitives[primitive].clone();
        if deformation.influences.is_empty() {
            let sets = self.influences(primitive, positions.count)?;
            let held = skin::held(&self.scene, &sets, &positions, joint_transforms)?;
            let what = [
                (held.weightless, "have no weight; their first joint holds them"),
                (held.uneven, "have weights that do not sum to 1; they are divided by their sum"),
            ];
            what.iter().filter(|(count, _)| *count > 0).for_each(|(count, what)| self.note(format!("{name}: {count} vertices {what}")));
            let deformation = &mut self.scene.primitives[primitive].deformation;
            (deformation.influences, deformation.joint_bounds) = (sets, held.bounds);
        } else if deformation.joint_bounds.len() > joint_transforms {
            return Err(
                LoadError::new(format!("names joint {} of {joint_transforms}", deformation.joint_bounds.len() - 1)).within("JOINTS_0")
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
                _ => return Err(LoadError::new(format!("is placed by a skin, but lacks JOINTS_{set} or WEIGHTS_{set}"))),
            };
            if set == 2 {
                let name = self.scene.primitives[primitive].name.clone();
                self.note(format!("{name}: of more than 8 joints per vertex, the first 8 are followed"));
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
