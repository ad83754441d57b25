//! Draws: every instance with its matrices and its place in the global lists of vertices and triangles.

use glam::DMat4;

use super::{
    Primitive, Scene,
    camera::View,
    pose::{Bend, Pose},
};
use crate::math::rounded_columns;

/// Largest magnitude that a matrix entry or a coordinate may have: 2^40 (the gate that keeps all products finite).
pub const MAX_MAGNITUDE: f64 = (1u64 << 40) as f64;

/// One instance, ready to be projected.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// Index into `Scene::primitives`.
    pub primitive: usize,
    /// Place of its vertices in `Geometry::vertices`.
    pub first_vertex: u32,
    /// Global id of its triangle 0.
    pub first_triangle: u32,
    /// Columns; multiplied in f64 and rounded once, so that every judge starts from these bits.
    pub clip_from_object: [[f32; 4]; 4],
    pub world_from_object: DMat4,
    /// The placement turns left into right, so front faces wind the other way.
    pub mirrored: bool,
    /// What bends its vertices before they are placed.
    pub bend: Option<Bend>,
    /// Place of its vertices among those of all draws that may bend.
    pub first_soft: u32,
}

impl Draw {
    /// Box round its vertices in object space, however they are bent.
    pub fn object_bounds(&self, primitive: &Primitive) -> super::Bounds {
        self.bend.as_ref().map_or(primitive.bounds, |bend| bend.bounds(primitive))
    }
}

/// A scene and viewpoint that the arithmetic cannot hold.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    #[error("{instance}: the placement or camera has a matrix entry of {value:e}; it must be finite and below 2^40 (1.1e12)")]
    Matrix { instance: String, value: f64 },
    #[error("the scene has {count} {what}; at most {limit} fit one picture")]
    TooMany { what: &'static str, count: u64, limit: u64 },
}

/// Most triangles in one picture: ids share their word with a flag.
pub const MAX_TRIANGLES: u64 = (1 << 31) - 2;

/// Lists the draws of `scene` as `view` sees it, in instance order.
pub fn draws(scene: &Scene, view: &View) -> Result<Vec<Draw>, DrawError> {
    for (what, count) in [("triangles", scene.triangle_count()), ("vertices", scene.vertex_count())] {
        if count > MAX_TRIANGLES {
            return Err(DrawError::TooMany { what, count, limit: MAX_TRIANGLES });
        }
    }
    let at_rest = if view.pose.is_none() { Pose::at_rest(scene) } else { None };
    let pose = view.pose.as_deref().or(at_rest.as_ref());
    let (mut first_vertex, mut first_triangle, mut first_soft) = (0, 0, 0);
    let place = |(index, instance): (usize, &super::Instance)| {
        let primitive = &scene.primitives[instance.primitive];
        let bend = pose.and_then(|pose| pose.bend(index)).cloned();
        let world_from_object = view.world_from_scene * pose.map_or(instance.world_from_object, |pose| pose.place(index));
        let clip_from_object = rounded_columns(&(view.clip_from_world * world_from_object));
        let entries = clip_from_object.iter().flatten().map(|&v| f64::from(v)).chain(world_from_object.to_cols_array());
        let joints = bend.iter().filter_map(|bend| bend.palette.as_ref()).flat_map(|palette| palette.matrices());
        let entries = entries.chain(view.clip_from_world.to_cols_array()).chain(joints.flat_map(|joint| joint.to_cols_array()));
        if let Some(value) = entries.into_iter().find(|v| !v.is_finite() || v.abs() >= MAX_MAGNITUDE) {
            return Err(DrawError::Matrix { instance: primitive.name.clone(), value });
        }
        let draw = Draw {
            primitive: instance.primitive,
            first_vertex,
            first_triangle,
            clip_from_object,
            world_from_object,
            mirrored: (world_from_object.determinant() < 0.0) != bend.as_ref().is_some_and(Bend::mirrors),
            bend,
            first_soft,
        };
        first_soft += if primitive.softness.is_none() { 0 } else { primitive.vertex_count() };
        first_vertex += primitive.vertex_count();
        first_triangle += primitive.triangle_count();
        Ok(draw)
    };
    scene.instances.iter().enumerate().map(place).collect()
}
