//! Skins: joints with their inverse bind matrices, and checks of the joints and weights of
//! vertices.

use glam::DMat4;

use super::{
    buffers::Buffers,
    document,
    error::{LoadError, called},
    limits,
    nodes::Tree,
};
use crate::scene::{
    accessor::{Accessor, ComponentType},
    bounds::Bounds,
    deformation::Influences,
    model::Scene,
    rig::Skin,
};

/// Reads every skin of the file. One that cannot be read has no joints, and what it should place is
/// drawn without it.
///
/// # Errors
/// The skins exceed their limits.
pub fn read_skins(buffers: &Buffers, tree: &Tree) -> Result<Vec<Skin>, LoadError> {
    let skins = &buffers.document.skins;
    let joints: usize = skins.iter().flatten().map(|skin| skin.joints.len()).sum();
    if joints > limits::ALL_JOINTS {
        return Err(LoadError::end(format!(
            "the skins have {joints} joints; allowed: at most {}",
            limits::ALL_JOINTS
        )));
    }
    let skin = |(index, about): (usize, &document::Part<document::Skin>)| {
        let (name, skin) = match about {
            Ok(about) => (
                called("skin", index, about.name.as_deref()),
                read(buffers, tree, about),
            ),
            Err(reason) => (called("skin", index, None), Err(LoadError::new(reason))),
        };
        match skin {
            Ok(skin) => Ok(Skin { name, ..skin }),
            Err(error) => {
                let reason = error.within(&name).of_part()?;
                buffers
                    .notes
                    .fault(|| format!("{reason}; what it should move is drawn without it"));
                Ok(Skin {
                    name,
                    joints: Vec::new(),
                    joint_from_mesh: Vec::new(),
                })
            }
        }
    };
    skins.iter().enumerate().map(skin).collect()
}

fn read(buffers: &Buffers, tree: &Tree, skin: &document::Skin) -> Result<Skin, LoadError> {
    let joints = skin.joints.len();
    let joint_from_mesh = match skin.inverse_bind {
        None => vec![DMat4::IDENTITY; joints],
        Some(accessor) => inverse_bind(buffers, accessor, joints)
            .map_err(|error| error.within("inverseBindMatrices"))?,
    };
    let nodes = skin.joints.iter().map(|&joint| tree.rig_index[joint]);
    let position = |(&joint, inverse): (&usize, &DMat4)| tree.world_from_node[joint] * *inverse;
    match skin
        .joints
        .iter()
        .zip(&joint_from_mesh)
        .position(|pair| !position(pair).is_finite())
    {
        Some(joint) => Err(LoadError::new(format!(
            "the matrix of joint {joint} is not finite"
        ))),
        None => Ok(Skin {
            name: String::new(),
            joints: nodes.collect(),
            joint_from_mesh,
        }),
    }
}

fn inverse_bind(buffers: &Buffers, index: usize, joints: usize) -> Result<Vec<DMat4>, LoadError> {
    let layout = buffers.layout(index)?;
    let about = layout.accessor;
    if about.component_type != ComponentType::F32 || about.components != 16 {
        return Err(LoadError::new("must be MAT4 of FLOAT"));
    }
    if (about.count as usize) < joints {
        return Err(LoadError::new(format!(
            "it has {} matrices for {joints} joints; it needs one for each",
            about.count
        )));
    }
    let bytes = buffers.materialized(index, &layout)?;
    let numbers = Accessor {
        offset: 0,
        stride: 64,
        ..about
    };
    let matrix = |i: u32| {
        DMat4::from_cols_array(&std::array::from_fn(|component| {
            numbers.value(&bytes, i, component as u32)
        }))
    };
    let matrices: Vec<DMat4> = (0..joints as u32).map(matrix).collect();
    // Exporters that round leave small errors in the last row, 0 0 0 1.
    let is_affine = |m: &DMat4| m.row(3).abs_diff_eq(glam::DVec4::W, 1e-3);
    match matrices
        .iter()
        .position(|m| !m.is_finite() || !is_affine(m))
    {
        Some(joint) => Err(LoadError::new(format!(
            "matrix {joint} must be finite and have the last row 0 0 0 1"
        ))),
        None => Ok(matrices),
    }
}

/// Checks the type and the count of a JOINTS or WEIGHTS attribute.
pub fn check_types(accessor: &Accessor, what: &str, count: u32) -> Result<(), LoadError> {
    let kinds: &[(ComponentType, bool)] = match what.starts_with("JOINTS") {
        true => &[(ComponentType::U8, false), (ComponentType::U16, false)],
        false => &[
            (ComponentType::F32, false),
            (ComponentType::U8, true),
            (ComponentType::U16, true),
        ],
    };
    if accessor.components != 4 || !kinds.contains(&(accessor.component_type, accessor.normalized))
    {
        return Err(LoadError::new("must be VEC4 of a type that glTF allows for it").within(what));
    }
    if accessor.count != count {
        return Err(LoadError::new(format!(
            "has {} elements, but the primitive has {count} vertices",
            accessor.count
        ))
        .within(what));
    }
    Ok(())
}

/// What checking the joints and weights of a mesh found.
pub struct CheckedInfluences {
    /// Box of the vertices of each joint, up to the largest joint in use.
    pub joint_bounds: Vec<Bounds>,
    /// The number of vertices whose weights are all 0; they follow their first joint.
    pub weightless: u32,
    /// The number of vertices whose weights do not sum to 1; they are normalized.
    pub not_normalized: u32,
}

/// Checks that all joints are below `joint_count` and that all weights are finite and not negative.
pub fn check_influences(
    scene: &Scene,
    sets: &[Influences],
    positions: &Accessor,
    joint_count: usize,
) -> Result<CheckedInfluences, LoadError> {
    let bytes = &scene.vertex_bytes;
    let mut checked = CheckedInfluences {
        joint_bounds: Vec::new(),
        weightless: 0,
        not_normalized: 0,
    };
    for vertex in 0..positions.count {
        let position = [0, 1, 2]
            .map(|component| positions.value(bytes, vertex, component))
            .into();
        let (mut sum, mut first) = (0.0, 0);
        for (set, influences) in sets.iter().enumerate() {
            for component in 0..4 {
                let joint = influences.joints.integer(bytes, vertex, component) as usize;
                let weight = influences.weights.value(bytes, vertex, component);
                if joint >= joint_count {
                    return Err(LoadError::new(format!("vertex {vertex} refers to joint {joint}, but the skin has {joint_count} joints"))
                        .within(format!("JOINTS_{set}")));
                }
                if !(weight.is_finite() && weight >= 0.0) {
                    return Err(LoadError::new(format!("vertex {vertex} has the weight {weight}; weights must be finite and at least 0"))
                        .within(format!("WEIGHTS_{set}")));
                }
                if joint >= checked.joint_bounds.len() {
                    checked.joint_bounds.resize(joint + 1, Bounds::EMPTY);
                }
                if weight > 0.0 {
                    checked.joint_bounds[joint].include(position);
                }
                if set == 0 && component == 0 {
                    first = joint;
                }
                sum += weight;
            }
        }
        if sum == 0.0 {
            checked.joint_bounds[first].include(position);
            checked.weightless += 1;
        } else if sum > 1e30 {
            return Err(LoadError::new(format!(
                "the weights of vertex {vertex} sum to {sum:e}; allowed: at most 1e30"
            ))
            .within("WEIGHTS_0"));
        } else if (sum - 1.0).abs() > 0.01 {
            checked.not_normalized += 1;
        }
    }
    Ok(checked)
}
