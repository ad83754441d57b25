//! Sample setups: the integers per triangle and clipped triangle that sample effects and masks test
//! samples against (`docs/exactness.md` §7).

use glam::DVec3;
use rayon::prelude::*;

use super::{
    super::{arithmetic::edge::doubled_area, shot::Shot},
    deform,
    mask::{self, MaskCoords},
    screen::center_screen,
    vertex::{Corner, VertexEvaluator},
};
use crate::{
    effects::{
        Stack,
        hooks::{SampleHook, TriangleSetup},
    },
    frame::{ClippedTriangle, Geometry, SnappedVertex},
    scene::{Scene, draw::totals},
};

/// The setups of every sample effect that has one, followed in a masked scene by mask coordinates:
/// for all triangles of `geometry`, then for all its clipped triangles. Zeros where nothing is
/// drawn: a corner is not ready, or the area is zero.
pub fn sample_setups(shot: &Shot, geometry: &Geometry) -> Vec<[u32; 4]> {
    let (effects, masks) = (
        effects_with_setup(shot.stack),
        mask_records(shot.scene, shot.stack),
    );
    if effects.len() + masks == 0 {
        return Vec::new();
    }
    let records = |entry: Option<SetupEntry>| {
        let of_effect = |(hook, words): &(&SampleHook, &[u32])| {
            entry.as_ref().map_or([0; 4], |entry| {
                (hook.sample_setup)(&entry.setup, words, None)
            })
        };
        let of_mask = entry
            .as_ref()
            .and_then(|entry| entry.mask.as_ref())
            .map_or([[0; 4]; mask::RECORDS], |(primitive, mask)| {
                mask.records(*primitive)
            });
        effects
            .iter()
            .map(of_effect)
            .chain(of_mask.into_iter().take(masks))
            .collect::<Vec<_>>()
    };
    entries(shot, geometry).flat_map_iter(records).collect()
}

/// What is known of a triangle or clipped triangle.
pub struct SetupEntry {
    /// Without the errors of the center.
    pub setup: TriangleSetup,
    /// It is of a clipped triangle, whose center in the picture follows from clip space.
    pub is_clipped: bool,
    /// Mask coordinates with the number of the primitive; none without a mask.
    pub mask: Option<(usize, MaskCoords)>,
}

/// Records that masks take per entry.
pub fn mask_records(scene: &Scene, stack: &Stack) -> usize {
    if mask::is_masked(scene, stack) {
        mask::RECORDS
    } else {
        0
    }
}

/// The sample effects of a stack that have a setup, with their parameter words.
pub fn effects_with_setup(stack: &Stack) -> Vec<(&SampleHook, &[u32])> {
    stack
        .each(|hooks| hooks.sample.as_ref().filter(|hook| hook.has_setup))
        .collect()
}

/// Entries of all triangles, then of all clipped triangles; none where nothing is drawn.
pub fn entries<'a>(
    shot: &'a Shot<'a>,
    geometry: &'a Geometry,
) -> impl IndexedParallelIterator<Item = Option<SetupEntry>> + 'a {
    let whole = move |id: u32| {
        let records = shot.corner_records(shot.draw_of(id)?, geometry, id);
        let is_drawn =
            records.iter().all(|record| record.flags == 0) && doubled_area(&records) != 0;
        is_drawn
            .then(|| entry(shot, geometry, id, &Drawn::Whole(records)))
            .flatten()
    };
    let clipped = move |triangle: &'a ClippedTriangle| {
        let is_drawn = doubled_area(&triangle.corners) != 0;
        is_drawn
            .then(|| entry(shot, geometry, triangle.parent, &Drawn::Clipped(triangle)))
            .flatten()
    };
    let wholes = totals(shot.scene, shot.draws)[1] as usize;
    (0..wholes + geometry.clipped_triangles.len())
        .into_par_iter()
        .map(move |index| match index.checked_sub(wholes) {
            None => whole(index as u32),
            Some(index) => clipped(&geometry.clipped_triangles[index]),
        })
}

/// What is drawn of a triangle.
enum Drawn<'a> {
    Whole([SnappedVertex; 3]),
    Clipped(&'a ClippedTriangle),
}

fn entry(shot: &Shot, geometry: &Geometry, id: u32, drawn: &Drawn) -> Option<SetupEntry> {
    const ALL_EDGES: u32 = 7;
    let (snapped, outline, clipped) = match drawn {
        Drawn::Whole(corners) => (corners, ALL_EDGES, None),
        Drawn::Clipped(triangle) => (&triangle.corners, triangle.outline, Some(&triangle.corners)),
    };
    let Shot {
        scene, view, stack, ..
    } = *shot;
    let draw = shot.draw_of(id)?;
    let evaluator = VertexEvaluator::new(scene, draw, view, stack);
    let triangle = id - draw.first_triangle;
    let vertices = scene.primitives[draw.primitive].corners(scene, triangle);
    let [Ok(a), Ok(b), Ok(c)] = vertices.map(|vertex| deform::position(scene, draw, vertex)) else {
        return None;
    };
    let world = [a, b, c].map(|position| draw.world_from_object.transform_point3(position));
    let center = world.iter().sum::<DVec3>() / 3.0;
    let corners = vertices.map(|vertex| Corner { vertex, triangle });
    let has_masks = mask::is_masked(scene, stack);
    let mask = has_masks
        .then(|| MaskCoords::of(&evaluator, view, corners, clipped))
        .flatten();
    let on_screen = || {
        center_screen(
            &evaluator,
            view,
            &shot.corner_records(draw, geometry, id),
            corners,
        )
    };
    let setup = TriangleSetup {
        triangle: id,
        corners: snapped.map(|corner| [corner.x, corner.y]),
        outline,
        size: [view.width, view.height],
        center,
        center_error_m: 0.0,
        center_screen_error: 0.0,
        center_screen: evaluator.in_picture(center).unwrap_or_else(on_screen),
    };
    Some(SetupEntry {
        setup,
        is_clipped: clipped.is_some(),
        mask: mask.map(|mask| (draw.primitive, mask)),
    })
}
