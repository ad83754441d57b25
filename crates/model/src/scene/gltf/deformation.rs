//! Deformation: the morph targets of primitives, and the joints and weights of skinned ones.

use gltf::json::{self, mesh::Semantic, validation::Checked};

use super::{
    buffers::{FLOAT, Format, SceneWriter},
    checks::check_finite,
    error::LoadError,
    skin,
};
use crate::scene::{
    accessor::{Accessor, ComponentType},
    deformation::{Influences, MorphTarget},
    rig::Skin,
};

/// The formats of displacements under KHR_mesh_quantization.
const QUANTIZED_DISPLACEMENTS: &[Format] = &[
    (ComponentType::F32, false),
    (ComponentType::I8, false),
    (ComponentType::I8, true),
    (ComponentType::I16, false),
    (ComponentType::I16, true),
];

/// Sets of four joints per vertex that are read; more are skipped with a note.
const MAX_INFLUENCE_SETS: u32 = 2;

/// Returns true if the file has animations, skinned meshes or morph targets.
pub fn has_motion(root: &json::Root) -> bool {
    let has_targets = |primitive: &json::mesh::Primitive| {
        primitive
            .targets
            .as_ref()
            .is_some_and(|targets| !targets.is_empty())
    };
    let is_skinned = root
        .nodes
        .iter()
        .any(|node| node.skin.is_some() && node.mesh.is_some());
    !root.animations.is_empty()
        || is_skinned
        || root
            .meshes
            .iter()
            .flat_map(|mesh| &mesh.primitives)
            .any(has_targets)
}

/// Reads the morph targets of a primitive of `count` vertices. Errors begin as those of attributes
/// do.
pub fn morph_targets(
    writer: &mut SceneWriter,
    about: &json::mesh::Primitive,
    count: u32,
) -> Result<Vec<MorphTarget>, LoadError> {
    let targets = about.targets.iter().flatten().enumerate();
    let read = |(index, target)| {
        morph_target(writer, target, count)
            .map_err(|error| LoadError(format!(" target {index} {error}")))
    };
    targets.map(read).collect()
}

fn morph_target(
    writer: &mut SceneWriter,
    target: &json::mesh::MorphTarget,
    count: u32,
) -> Result<MorphTarget, LoadError> {
    let mut read =
        |index: Option<json::Index<json::Accessor>>, what: &str| -> Result<_, LoadError> {
            let Some(index) = index else { return Ok(None) };
            let formats = if writer.is_quantized {
                QUANTIZED_DISPLACEMENTS
            } else {
                FLOAT
            };
            let accessor = writer
                .attribute(index.value(), count, &[3], formats)
                .map_err(|error| error.within(what))?;
            check_finite(&writer.scene, &accessor).map_err(|error| error.within(what))?;
            Ok(Some(accessor))
        };
    let (positions, normals) = (
        read(target.positions, "POSITION")?,
        read(target.normals, "NORMAL")?,
    );
    let max_displacement = positions.map_or(0.0, |accessor| {
        let value = |vertex| {
            [0, 1, 2].map(|component| {
                accessor
                    .value(&writer.scene.vertex_bytes, vertex, component)
                    .abs()
            })
        };
        (0..count).flat_map(value).fold(0.0, f64::max)
    });
    Ok(MorphTarget {
        positions,
        normals,
        max_displacement,
    })
}

/// Reads the joints and weights of a primitive that `skin` places, unless that was done before.
/// Returns messages to the user.
pub fn follow_skin(
    writer: &mut SceneWriter,
    primitive: usize,
    about: &json::mesh::Primitive,
    skin: &Skin,
) -> Result<Vec<String>, LoadError> {
    let joint_count = skin.joints.len();
    let known = &writer.scene.primitives[primitive];
    if !known.deformation.influences.is_empty() {
        let largest = known.deformation.joint_bounds.len().saturating_sub(1);
        return if largest < joint_count {
            Ok(Vec::new())
        } else {
            Err(LoadError::new(format!(
                "refers to joint {largest}, but the skin has {joint_count} joints"
            ))
            .within("JOINTS_0"))
        };
    }
    let (name, positions) = (known.name.clone(), known.positions);
    let mut notes = Vec::new();
    let sets = influences(writer, about, positions.count)?;
    if has_attribute(about, Semantic::Joints(MAX_INFLUENCE_SETS)) {
        notes.push(format!(
            "{name}: only the first 8 joints per vertex are used"
        ));
    }
    let checked = skin::check_influences(&writer.scene, &sets, &positions, joint_count)?;
    for (count, what) in [
        (
            checked.weightless,
            "have only weights of 0; they follow their first joint",
        ),
        (
            checked.not_normalized,
            "have weights that do not sum to 1; they are normalized",
        ),
    ] {
        if count > 0 {
            notes.push(format!("{name}: {count} vertices {what}"));
        }
    }
    let deformation = &mut writer.scene.primitives[primitive].deformation;
    (deformation.influences, deformation.joint_bounds) = (sets, checked.joint_bounds);
    Ok(notes)
}

fn attribute(about: &json::mesh::Primitive, semantic: Semantic) -> Option<usize> {
    about
        .attributes
        .get(&Checked::Valid(semantic))
        .map(|accessor| accessor.value())
}

fn has_attribute(about: &json::mesh::Primitive, semantic: Semantic) -> bool {
    attribute(about, semantic).is_some()
}

/// Reads all sets of joints and weights, at least one.
fn influences(
    writer: &mut SceneWriter,
    about: &json::mesh::Primitive,
    count: u32,
) -> Result<Vec<Influences>, LoadError> {
    let mut sets = Vec::new();
    for set in 0..=MAX_INFLUENCE_SETS {
        let (joints, weights) = match (
            attribute(about, Semantic::Joints(set)),
            attribute(about, Semantic::Weights(set)),
        ) {
            (Some(joints), Some(weights)) => (joints, weights),
            (None, None) if set > 0 => break,
            _ => {
                return Err(LoadError::new(format!(
                    "it has a skin, but lacks JOINTS_{set} or WEIGHTS_{set}; export both"
                )));
            }
        };
        if set == MAX_INFLUENCE_SETS {
            break;
        }
        let mut read = |index: usize, what: &str| -> Result<Accessor, LoadError> {
            let what = format!("{what}_{set}");
            let accessor = writer
                .accessor(index)
                .map_err(|error| error.within(&what))?;
            skin::check_types(&accessor, &what, count)?;
            writer
                .copy_attribute(index)
                .map_err(|error| error.within(&what))
        };
        sets.push(Influences {
            joints: read(joints, "JOINTS")?,
            weights: read(weights, "WEIGHTS")?,
        });
    }
    Ok(sets)
}
