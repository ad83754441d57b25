//! The vertex stage of a picture in f64: deform, move, project, snap once, and clip.

use rayon::prelude::*;

use super::{
    super::shot::Shot,
    clip, deform,
    records::fill_records,
    shading::TOGETHER,
    snap::{ClipPosition, snap},
    vertex::{Corner, VertexEvaluator},
};
use crate::{
    frame::{Geometry, SnappedVertex},
    scene::draw::Draw,
    work::Canceled,
};

/// Everything between the stored scene and integer coverage: one record per vertex of each draw, or
/// three per triangle if the stack unshares vertices, and the clipped triangles of every triangle
/// that the near plane or the guard band cuts, including those that flip.
pub fn project(shot: &Shot) -> Result<Geometry, Canceled> {
    let Shot {
        scene,
        draws,
        view,
        stack,
    } = *shot;
    let record = |clip: Result<ClipPosition, u32>| match clip {
        Ok(position) => snap(&position, view),
        Err(flags) => SnappedVertex {
            flags,
            ..Default::default()
        },
    };
    let vertices = fill_records(shot, |evaluator, first, records| {
        for (part, records) in records.chunks_mut(TOGETHER).enumerate() {
            let first = first + part * TOGETHER;
            let corners: Vec<Corner> = (first..first + records.len())
                .map(|record| evaluator.corner(record))
                .collect();
            for (to, clip) in records.iter_mut().zip(evaluator.clip_all(&corners)) {
                *to = record(clip);
            }
        }
    })?;
    let mut geometry = Geometry {
        vertices,
        has_unshared_vertices: stack.unshares_vertices(),
        deformed: draws
            .iter()
            .flat_map(|draw| deform::vertices(scene, draw))
            .collect(),
        particle_discs: scene.particle_disc_ids(),
        subpixel_bits: view.precision.subpixel_bits,
        ..Geometry::default()
    };
    let clipped = |draw: &Draw| {
        let evaluator = VertexEvaluator::new(scene, draw, view, stack);
        let position = |corner| {
            evaluator
                .clip(corner)
                .expect("a triangle that is clipped has no rejected corner")
        };
        clip::clipped_triangles(shot, draw, &geometry, position)
    };
    geometry.clipped_triangles = draws.par_iter().flat_map(clipped).collect();
    Ok(geometry)
}
