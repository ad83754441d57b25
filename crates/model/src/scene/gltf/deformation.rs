//! Deformation: the morph targets of primitives, and the joints and weights of skinned ones.

use std::collections::BTreeMap;

use super::{
    buffers::{FLOAT, FLOAT_OR_UNORM, Format, SceneWriter},
    checks::check_finite,
    document::{Document, Primitive},
    error::LoadError,
    notes::Notes,
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
pub fn has_motion(document: &Document) -> bool {
    let is_skinned = document
        .nodes
        .iter()
        .any(|node| node.skin.is_some() && node.mesh.is_some());
    let has_targets = || {
        let mut primitives = document.meshes.iter().flat_map(|mesh| mesh.sound());
        primitives.any(|(_, primitive)| !primitive.targets.is_empty())
    };
    !document.clips.is_empty() || is_skinned || has_targets()
}

/// Reads the morph targets of a primitive of `count` vertices, which messages call `name`. What
/// cannot be read displaces nothing.
///
/// # Errors
/// Loading ends.
pub fn morph_targets(
    writer: &mut SceneWriter,
    (name, about): (&str, &Primitive),
    count: u32,
    notes: &Notes,
) -> Result<Vec<MorphTarget>, LoadError> {
    let mut read =
        |target: &BTreeMap<String, usize>, at: usize, what: &str| -> Result<_, LoadError> {
            let Some(&accessor) = target.get(what) else {
                return Ok(None);
            };
            match displacements(writer, accessor, count) {
                Ok(accessor) => Ok(Some(accessor)),
                Err(error) => {
                    let place = format_args!("{name} target {at} {what}");
                    let reason = error.within(place).of_part()?;
                    notes.fault(|| format!("{reason}; it is left out"));
                    Ok(None)
                }
            }
        };
    let mut targets = Vec::with_capacity(about.targets.len());
    for (at, target) in about.targets.iter().enumerate() {
        targets.push((read(target, at, "POSITION")?, read(target, at, "NORMAL")?));
    }
    let bytes = &writer.scene.vertex_bytes;
    let largest = |accessor: Accessor| {
        let value = |vertex| [0, 1, 2].map(|c| accessor.value(bytes, vertex, c).abs());
        (0..count).flat_map(value).fold(0.0, f64::max)
    };
    let target = |(positions, normals): (Option<Accessor>, Option<Accessor>)| MorphTarget {
        positions,
        normals,
        max_displacement: positions.map_or(0.0, largest),
    };
    Ok(targets.into_iter().map(target).collect())
}

/// Colors or texture coordinates of a primitive after its morph targets; `accessor` itself where none
/// moves them. A target that cannot be read moves nothing.
///
/// # Errors
/// There would be too many bytes, or loading was canceled.
pub fn moved(
    writer: &mut SceneWriter,
    about: &Primitive,
    name: &str,
    accessor: Accessor,
    weights: &[f32],
) -> Result<Accessor, LoadError> {
    const SIGNED: [Format; 2] = [(ComponentType::I8, true), (ComponentType::I16, true)];
    let formats = [FLOAT_OR_UNORM, &SIGNED].concat();
    let mut targets = Vec::new();
    for (target, weight) in about.targets.iter().zip(weights) {
        let Some(&index) = target.get(name).filter(|_| *weight != 0.0) else {
            continue;
        };
        match writer.attribute(index, accessor.count, &[2, 3, 4], &formats) {
            Ok(read) if check_finite(&writer.scene, &read).is_ok() => {
                targets.push((read, f64::from(*weight)));
            }
            Ok(_) => {}
            Err(error) => drop(error.of_part()?),
        }
    }
    if targets.is_empty() {
        return Ok(accessor);
    }
    let (bytes, is_color) = (&writer.scene.vertex_bytes, name.starts_with("COLOR"));
    let mut values = Vec::with_capacity((accessor.count * accessor.components) as usize);
    for vertex in 0..accessor.count {
        for component in 0..accessor.components {
            let moved = targets
                .iter()
                .filter(|(target, _)| component < target.components)
                .map(|(target, weight)| target.value(bytes, vertex, component) * weight)
                .sum::<f64>();
            let value = accessor.value(bytes, vertex, component) + moved;
            values.push(if is_color {
                value.clamp(0.0, 1.0)
            } else {
                value
            } as f32);
        }
    }
    writer.append_floats(accessor.components, &values)
}

fn displacements(
    writer: &mut SceneWriter,
    index: usize,
    count: u32,
) -> Result<Accessor, LoadError> {
    let formats = if writer.is_quantized {
        QUANTIZED_DISPLACEMENTS
    } else {
        FLOAT
    };
    let accessor = writer.attribute(index, count, &[3], formats)?;
    check_finite(&writer.scene, &accessor)?;
    Ok(accessor)
}

/// Reads the joints and weights of a primitive that `skin` places, unless that was done before.
///
/// # Errors
/// They cannot be read, or do not fit the skin.
pub fn follow_skin(
    writer: &mut SceneWriter,
    primitive: usize,
    about: &Primitive,
    skin: &Skin,
    notes: &Notes,
) -> Result<(), LoadError> {
    let joint_count = skin.joints.len();
    let known = &writer.scene.primitives[primitive];
    if !known.deformation.influences.is_empty() {
        let largest = known.deformation.joint_bounds.len().saturating_sub(1);
        return if largest < joint_count {
            Ok(())
        } else {
            Err(LoadError::new(format!(
                "refers to joint {largest}, but the skin has {joint_count} joints"
            ))
            .within("JOINTS_0"))
        };
    }
    let (name, positions) = (known.name.clone(), known.positions);
    let sets = influences(writer, about, positions.count)?;
    if about
        .attributes
        .contains_key(&format!("JOINTS_{MAX_INFLUENCE_SETS}"))
    {
        notes.add(|| format!("{name}: only the first 8 joints per vertex are used"));
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
            notes.fault(|| format!("{name}: {count} vertices {what}"));
        }
    }
    let deformation = &mut writer.scene.primitives[primitive].deformation;
    (deformation.influences, deformation.joint_bounds) = (sets, checked.joint_bounds);
    Ok(())
}

/// Reads all sets of joints and weights, at least one.
fn influences(
    writer: &mut SceneWriter,
    about: &Primitive,
    count: u32,
) -> Result<Vec<Influences>, LoadError> {
    let mut sets = Vec::new();
    for set in 0..=MAX_INFLUENCE_SETS {
        let (joints, weights) = match (
            about.attributes.get(&format!("JOINTS_{set}")),
            about.attributes.get(&format!("WEIGHTS_{set}")),
        ) {
            (Some(&joints), Some(&weights)) => (joints, weights),
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
