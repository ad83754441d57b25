//! The map behind the counts: the judgement of every sample once more, as marks on the picture.

use rayon::prelude::*;

use super::{
    coverage::{Coverage, Sample, corner_records, draw_of},
    judge::triangle_is_right,
};
use crate::{
    frame::{Frame, Geometry, NO_TRIANGLE},
    measure::faults::{ErrorMap, PixelError, is_nonfinite, is_unsound},
    scene::{Accessor, Scene, draw::Draw},
};

/// How samples are judged.
#[derive(Clone, Copy)]
pub(super) struct Manner {
    /// Among layers that race, any may win.
    pub is_racing: bool,
    /// The hardware chooses among samples, so that any of them may be missing.
    pub is_chosen: bool,
}

/// What is the matter with each pixel of `adapter`, whose colours are held against `colors`.
pub(super) fn faults(
    (scene, draws, geometry): (&Scene, &[Draw], &Geometry),
    coverage: &Coverage,
    adapter: &Frame,
    layers: Option<&[u32]>,
    colors: &[[u8; 4]],
    manner: Manner,
) -> ErrorMap {
    let unsound = unsound_ids(scene, draws, geometry, &adapter.triangle_id);
    ErrorMap::new(&adapter.color, colors, |i| {
        let (sample, triangle_id) = (&coverage.samples[i], adapter.triangle_id[i]);
        let hits = layers.map_or(u32::from(triangle_id != NO_TRIANGLE), |layers| layers[i]);
        let reference = if layers.is_some() { sample.layers } else { sample.layers.min(1) };
        let is_wrong = is_wrong(sample, triangle_id, manner);
        let marks = [
            (PixelError::TriangleId, is_wrong),
            (PixelError::Depth, is_wrong && sample.claimed.is_some()),
            (PixelError::Hole, !manner.is_chosen && hits < reference),
            (PixelError::Double, hits > reference),
            (PixelError::Tie, sample.is_band()),
            (PixelError::Unsound, is_unsound(adapter.key[i]) || unsound.binary_search(&triangle_id).is_ok()),
        ];
        marks.into_iter().filter(|(_, is_there)| *is_there).map(|(fault, _)| fault).collect()
    })
}

fn is_wrong(sample: &Sample, triangle_id: u32, manner: Manner) -> bool {
    if manner.is_chosen {
        return triangle_id != NO_TRIANGLE && sample.claimed.is_none();
    }
    let is_contested = manner.is_racing && sample.layers > 1 && sample.claimed.is_some();
    !is_contested && !triangle_is_right(sample, triangle_id)
}

/// Triangle ids with a corner whose depth, 1/w, normal or colour is no number to make a picture of; sorted. Corners that are
/// clipped or rejected are never read, and normals may well be negative.
fn unsound_ids(scene: &Scene, draws: &[Draw], geometry: &Geometry, triangle_ids: &[u32]) -> Vec<u32> {
    let is_soiled = |&triangle_id: &u32| {
        let Some(draw) = draw_of(scene, draws, triangle_id) else { return false };
        let primitive = &scene.primitives[draw.primitive];
        let vertices = primitive.corners(scene, triangle_id - draw.first_triangle);
        let any = |accessor: &Accessor, test: fn(u32) -> bool| {
            let bits = |vertex: u32, lane: u32| (accessor.value(&scene.vertex_bytes, vertex, lane) as f32).to_bits();
            vertices.iter().any(|&vertex| (0..accessor.components).any(|lane| test(bits(vertex, lane))))
        };
        let mut records = corner_records(scene, draw, geometry, triangle_id).into_iter().filter(|record| record.flags == 0);
        records.any(|record| is_unsound(record.depth.to_bits()) || is_unsound(record.inv_w.to_bits()))
            || any(&primitive.normals, is_nonfinite)
            || primitive.colors.as_ref().is_some_and(|colors| any(colors, is_unsound))
    };
    let mut triangle_ids = triangle_ids.to_vec();
    triangle_ids.par_sort_unstable();
    triangle_ids.dedup();
    triangle_ids.into_par_iter().filter(is_soiled).collect()
}
