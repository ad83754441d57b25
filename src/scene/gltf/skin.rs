//! Skins at rest: where joints hold the vertices while nothing is animated.

use glam::{DMat4, DVec3};
use gltf::json;

use super::{LoadError, buffers::Buffers, called, limits, nodes::Tree};
use crate::scene::{Accessor, Component};

/// Joint matrices of one skin, `world_from_joint * joint_from_mesh` (the inverse bind matrix).
pub struct Pose {
    pub world_from_mesh: Vec<DMat4>,
}

impl Pose {
    pub fn at_rest(buffers: &Buffers, tree: &Tree, skin: usize) -> Result<Self, LoadError> {
        let about = &buffers.root.skins[skin];
        Self::read(buffers, tree, about).map_err(|error| error.within(called("skin", skin, about.name.as_deref())))
    }

    fn read(buffers: &Buffers, tree: &Tree, skin: &json::Skin) -> Result<Self, LoadError> {
        let joints = skin.joints.len();
        if joints == 0 || joints > limits::JOINTS {
            return Err(LoadError::new(format!("{joints} joints lie outside 1..={}", limits::JOINTS)));
        }
        let inverse_bind = match skin.inverse_bind_matrices {
            None => vec![DMat4::IDENTITY; joints],
            Some(accessor) => inverse_bind(buffers, accessor.value(), joints).map_err(|error| error.within("inverseBindMatrices"))?,
        };
        let place = |(joint, inverse): (&json::Index<json::Node>, DMat4)| tree.world_from_node[joint.value()] * inverse;
        let world_from_mesh: Vec<DMat4> = skin.joints.iter().zip(inverse_bind).map(place).collect();
        match world_from_mesh.iter().position(|matrix| !matrix.is_finite()) {
            Some(joint) => Err(LoadError::new(format!("joint {joint} has a matrix that is not finite"))),
            None => Ok(Self { world_from_mesh }),
        }
    }

    /// The matrix that all joints share while the skeleton stands as it was bound: then the mesh is only placed, not bent.
    pub fn common(&self) -> Option<DMat4> {
        let first = self.world_from_mesh[0];
        let size = first.to_cols_array().into_iter().fold(0.0, |size: f64, v| size.max(v.abs()));
        self.world_from_mesh.iter().all(|matrix| matrix.abs_diff_eq(first, 1e-4 * size)).then_some(first)
    }

    /// Where the joints that hold a vertex take it: their matrices, averaged by weight.
    pub fn world_from_vertex(&self, influences: [(usize, f64); 4]) -> DMat4 {
        let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
        if sum <= 0.0 {
            return self.world_from_mesh[influences[0].0];
        }
        influences.iter().fold(DMat4::ZERO, |matrix, &(joint, weight)| matrix + self.world_from_mesh[joint] * (weight / sum))
    }
}

/// Joints and weights of vertices.
pub struct Influences {
    joints: Accessor,
    joint_bytes: Vec<u8>,
    weights: Accessor,
    weight_bytes: Vec<u8>,
}

impl Influences {
    /// Reads the first set of `count` vertices. Refuses joints past `palette`, and weights that are negative or not finite.
    pub fn read(buffers: &Buffers, [joints, weights]: [usize; 2], count: u32, palette: usize) -> Result<Self, LoadError> {
        let numbers = |accessor: usize, what: &str, kinds: &[(Component, bool)]| {
            let (numbers, bytes) = packed(buffers, accessor).map_err(|error| error.within(what))?;
            if numbers.lanes != 4 || !kinds.contains(&(numbers.component, numbers.normalized)) {
                return Err(LoadError::new("is not VEC4 of a type that glTF allows here").within(what));
            }
            if numbers.count != count {
                return Err(LoadError::new(format!("has {} elements for {count} vertices", numbers.count)).within(what));
            }
            Ok((numbers, bytes))
        };
        let (joints, joint_bytes) = numbers(joints, "JOINTS_0", &[(Component::U8, false), (Component::U16, false)])?;
        let weight_kinds = [(Component::F32, false), (Component::U8, true), (Component::U16, true)];
        let (weights, weight_bytes) = numbers(weights, "WEIGHTS_0", &weight_kinds)?;
        let influences = Self { joints, joint_bytes, weights, weight_bytes };
        for vertex in 0..count {
            for (joint, weight) in influences.at(vertex) {
                if joint >= palette {
                    return Err(LoadError::new(format!("vertex {vertex} names joint {joint} of {palette}")).within("JOINTS_0"));
                }
                if !(weight.is_finite() && weight >= 0.0) {
                    return Err(LoadError::new(format!("vertex {vertex} has the weight {weight}")).within("WEIGHTS_0"));
                }
            }
        }
        Ok(influences)
    }

    pub fn at(&self, vertex: u32) -> [(usize, f64); 4] {
        [0, 1, 2, 3].map(|lane| {
            let joint = self.joints.integer(&self.joint_bytes, vertex, lane) as usize;
            (joint, self.weights.value(&self.weight_bytes, vertex, lane))
        })
    }
}

/// Any accessor as packed bytes with an accessor that reads them.
fn packed(buffers: &Buffers, index: usize) -> Result<(Accessor, Vec<u8>), LoadError> {
    let layout = buffers.layout(index)?;
    let bytes = buffers.materialized(index, &layout)?;
    let accessor = layout.accessor;
    Ok((Accessor { offset: 0, stride: accessor.component.bytes() * accessor.lanes, ..accessor }, bytes))
}

fn inverse_bind(buffers: &Buffers, index: usize, joints: usize) -> Result<Vec<DMat4>, LoadError> {
    let about = buffers.layout(index)?.accessor;
    if about.component != Component::F32 || about.lanes != 16 {
        return Err(LoadError::new("is not MAT4 of FLOAT"));
    }
    if (about.count as usize) < joints || about.count as usize > limits::JOINTS {
        return Err(LoadError::new(format!("has {} matrices for {joints} joints", about.count)));
    }
    let (numbers, bytes) = packed(buffers, index)?;
    let matrix = |i: u32| DMat4::from_cols_array(&std::array::from_fn(|lane| numbers.value(&bytes, i, lane as u32)));
    Ok((0..joints as u32).map(matrix).collect())
}

/// Directions under a matrix as normals: by its cofactors, so that a flattened mesh keeps finite normals.
pub fn bent_normal(matrix: &DMat4, normal: DVec3) -> DVec3 {
    let (x, y, z) = (matrix.x_axis.truncate(), matrix.y_axis.truncate(), matrix.z_axis.truncate());
    y.cross(z) * normal.x + z.cross(x) * normal.y + x.cross(y) * normal.z
}
