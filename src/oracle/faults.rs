//! The map behind the counts: the judgement of every sample once more, as marks on the picture.

use rayon::prelude::*;

use super::{
    coverage::{Coverage, Sample, corner_records, draw_of},
    judge::owner_is_right,
};
use crate::{
    frame::{Frame, Geometry, NO_OWNER},
    measure::faults::{Fault, Faults, is_nonfinite, is_unsound},
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
) -> Faults {
    let unsound = unsound_owners(scene, draws, geometry, &adapter.owner);
    Faults::new(&adapter.color, colors, |i| {
        let (sample, owner) = (&coverage.samples[i], adapter.owner[i]);
        let hits = layers.map_or(u32::from(owner != NO_OWNER), |layers| layers[i]);
        let truth = if layers.is_some() { sample.layers } else { sample.layers.min(1) };
        let is_wrong = is_wrong(sample, owner, manner);
        let marks = [
            (Fault::Owner, is_wrong),
            (Fault::Depth, is_wrong && sample.claimed.is_some()),
            (Fault::Hole, !manner.is_chosen && hits < truth),
            (Fault::Double, hits > truth),
            (Fault::Tie, sample.is_band()),
            (Fault::Unsound, is_unsound(adapter.key[i]) || unsound.binary_search(&owner).is_ok()),
        ];
        marks.into_iter().filter(|(_, is_there)| *is_there).map(|(fault, _)| fault).collect()
    })
}

fn is_wrong(sample: &Sample, owner: u32, manner: Manner) -> bool {
    if manner.is_chosen {
        return owner != NO_OWNER && sample.claimed.is_none();
    }
    let is_contested = manner.is_racing && sample.layers > 1 && sample.claimed.is_some();
    !is_contested && !owner_is_right(sample, owner)
}

/// Owners with a corner whose depth, 1/w, normal or colour is no number to make a picture of; sorted. Corners that are
/// clipped or rejected are never read, and normals may well be negative.
fn unsound_owners(scene: &Scene, draws: &[Draw], geometry: &Geometry, owners: &[u32]) -> Vec<u32> {
    let is_soiled = |&owner: &u32| {
        let Some(draw) = draw_of(scene, draws, owner) else { return false };
        let primitive = &scene.primitives[draw.primitive];
        let vertices = primitive.corners(scene, owner - draw.first_triangle);
        let any = |accessor: &Accessor, test: fn(u32) -> bool| {
            let bits = |vertex: u32, lane: u32| (accessor.value(&scene.vertex_bytes, vertex, lane) as f32).to_bits();
            vertices.iter().any(|&vertex| (0..accessor.lanes).any(|lane| test(bits(vertex, lane))))
        };
        let mut records = corner_records(scene, draw, geometry, owner).into_iter().filter(|record| record.flags == 0);
        records.any(|record| is_unsound(record.depth.to_bits()) || is_unsound(record.inv_w.to_bits()))
            || any(&primitive.normals, is_nonfinite)
            || primitive.colors.as_ref().is_some_and(|colors| any(colors, is_unsound))
    };
    let mut owners = owners.to_vec();
    owners.par_sort_unstable();
    owners.dedup();
    owners.into_par_iter().filter(is_soiled).collect()
}
