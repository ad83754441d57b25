//! Triangle sizes after effects have moved the corners, estimated from a bounded sample of the triangles.

use glam::DVec4;

use super::vertex::{Corner, VertexEvaluator};
use crate::{
    effects::Stack,
    scene::{
        Scene,
        draw::{Draw, DrawError},
        sizes::TriangleSizes,
        view::View,
    },
};

/// Samples triangles of `scene` as `view` sees them where the effects of `stack` have moved them. A triangle with a corner that is refused
/// counts as hidden.
///
/// # Errors
/// [`DrawError`] if a transform or the number of triangles is out of range.
pub fn moved_sizes(scene: &Scene, view: &View, stack: &Stack) -> Result<TriangleSizes, DrawError> {
    let draws: Vec<Draw> = stack.draws(scene, view)?;
    let evaluators: Vec<_> = draws.iter().map(|draw| VertexEvaluator::new(scene, draw, view, stack)).collect();
    let clip = |evaluator: &VertexEvaluator<'_>, corner: Corner| match evaluator.clip(corner) {
        Ok(position) => DVec4::new(position.x, position.y, position.z, position.w),
        Err(_) => DVec4::NAN,
    };
    let corners = |index: usize, triangle: u32| {
        let evaluator = &evaluators[index];
        evaluator.triangle_corners(triangle).map(|corner| clip(evaluator, corner))
    };
    Ok(TriangleSizes::of_corners(scene, &draws, view, corners))
}
