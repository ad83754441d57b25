//! The vertex stage of a picture in f64: deform, move, project, snap once, and clip.

use rayon::prelude::*;

use super::{super::shot::Shot, clip, deform, snap::snap, vertex::VertexEvaluator};
use crate::{
    frame::{Geometry, SnappedVertex},
    scene::draw::totals,
    work::{Canceled, map_each},
};

/// Everything between the stored scene and integer coverage: one record per vertex of each draw, or
/// three per triangle if the stack unshares vertices, and the clipped triangles of every triangle
/// that the near plane or the guard band cuts, including those that flip.
///
/// # Errors
/// The work was canceled.
pub fn project(shot: &Shot) -> Result<Geometry, Canceled> {
    let Shot {
        scene,
        draws,
        view,
        stack,
    } = *shot;
    let evaluators: Vec<VertexEvaluator> = draws
        .iter()
        .map(|draw| VertexEvaluator::new(scene, draw, view, stack))
        .collect();
    let records = |evaluator: &VertexEvaluator| {
        let record = |corner| match evaluator.clip(corner) {
            Ok(position) => snap(&position, view),
            Err(flags) => SnappedVertex {
                flags,
                ..Default::default()
            },
        };
        map_each(evaluator.corners().into_par_iter(), record)
    };
    // One list of the right size: growing it would need twice the memory.
    let [shared, triangles] = totals(scene, draws);
    let mut vertices = Vec::with_capacity(if stack.unshares_vertices() {
        3 * triangles
    } else {
        shared
    } as usize);
    for evaluator in &evaluators {
        vertices.extend(records(evaluator)?);
    }
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
    let clipped = |evaluator: &VertexEvaluator| {
        let position = |corner| {
            evaluator
                .clip(corner)
                .expect("a triangle that is clipped has no rejected corner")
        };
        clip::clipped_triangles(shot, evaluator.draw, &geometry, position)
    };
    geometry.clipped_triangles = evaluators.iter().flat_map(clipped).collect();
    Ok(geometry)
}
