//! Decisions: what sample effects settle once per triangle and per piece, and the judgement of an adapter's.

use glam::DVec3;
use rayon::prelude::*;

use super::{
    coverage::{corner_records, doubled_area, draw_of},
    deform::bounded_place,
    mask,
    moved::{Corner, VertexEvaluator},
    surface::center_screen,
};
use crate::{
    effects::{
        Stack,
        hooks::{SampleHook, TriangleSetup},
    },
    frame::{ClippedTriangle, Geometry, SnappedVertex},
    scene::{
        Scene,
        draw::{Draw, totals},
        view::View,
    },
};

/// Relative spacing of f32.
const ULP: f64 = f32::EPSILON as f64;

/// What every deciding effect of `stack` settles, and behind it, in a scene with masks, where corners lie in their images: for
/// all triangles of `geometry`, then for all its pieces. Zeros where nothing is drawn: corners that are not ready, no area.
pub fn decide(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack, geometry: &Geometry) -> Vec<[u32; 4]> {
    let (effects, masks) = (deciding(stack), masks(scene, stack));
    if effects.len() + masks == 0 {
        return Vec::new();
    }
    let settle = |entry: Option<Entry>| {
        let (setup, places) = entry.map_or((None, None), |(setup, places)| (Some(setup), places));
        let one = |(hook, words): &(SampleHook, &[u32])| setup.as_ref().map_or([0; 4], |setup| (hook.decide)(setup, words, None));
        let places = places.map_or([[0; 4]; mask::RECORDS], |(primitive, places)| places.records(primitive));
        effects.iter().map(one).chain(places.into_iter().take(masks)).collect::<Vec<_>>()
    };
    entries(scene, draws, view, stack, geometry).flat_map_iter(settle).collect()
}

/// Decisions that are not what the rules say: a first word beyond its bound, or another that does not follow from it.
pub(super) fn wrong(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack, geometry: &Geometry) -> u64 {
    let (effects, masks) = (deciding(stack), masks(scene, stack));
    let records = effects.len() + masks;
    if records == 0 {
        return 0;
    }
    let whole = totals(scene, draws)[1] as usize;
    assert_eq!(geometry.sample_setups.len(), records * (whole + geometry.pieces.len()), "the decisions are of another scene");
    let is_wrong = |setup: &TriangleSetup, (hook, words): &(SampleHook, &[u32]), given: [u32; 4]| {
        let reference = (hook.decide)(setup, words, None);
        let is_near = f64::from(reference[0].abs_diff(given[0])) <= (hook.error_bound)(setup, words);
        !is_near || (hook.decide)(setup, words, Some(given[0])) != given
    };
    let faults = |(entry, given): (Option<Entry>, &[[u32; 4]])| {
        let Some((setup, places)) = entry else { return 0 };
        let places_are_wrong = match (masks, places) {
            (0, _) => false,
            (_, None) => given[records - 1][2] != 0,
            (_, Some((_, places))) => !places.allow(&given[effects.len()..]),
        };
        let wrong = effects.iter().zip(given).filter(|(effect, given)| is_wrong(&setup, effect, **given)).count();
        (wrong + usize::from(places_are_wrong)) as u64
    };
    entries(scene, draws, view, stack, geometry).zip(geometry.sample_setups.par_chunks(records)).map(faults).sum()
}

/// TriangleSetup about a triangle or piece, and where its corners lie in the image of its primitive, where that masks it.
type Entry = (TriangleSetup, Option<(usize, mask::Places)>);

/// Records that masks take per entry.
fn masks(scene: &Scene, stack: &Stack) -> usize {
    if mask::is_there(scene, stack) { mask::RECORDS } else { 0 }
}

fn deciding(stack: &Stack) -> Vec<(SampleHook, &[u32])> {
    stack.each(|hooks| hooks.sample.filter(|hook| hook.has_setup)).collect()
}

/// TriangleSetup of all triangles, then of all pieces; none where nothing is drawn.
fn entries<'a>(
    scene: &'a Scene,
    draws: &'a [Draw],
    view: &'a View,
    stack: &'a Stack,
    geometry: &'a Geometry,
) -> impl IndexedParallelIterator<Item = Option<Entry>> + 'a {
    let has_masks = masks(scene, stack) > 0;
    let whole = move |id: u32| {
        let draw = draw_of(scene, draws, id)?;
        let records = corner_records(scene, draw, geometry, id);
        let is_drawn = records.iter().all(|record| record.flags == 0) && doubled_area(&records) != 0;
        is_drawn
            .then(|| {
                entry(&VertexEvaluator::new(scene, draw, view, stack), scene, view, geometry, id, Shown::EndToEnd(&records), has_masks)
            })
            .flatten()
    };
    let pieces = move |piece: &ClippedTriangle| {
        let draw = draw_of(scene, draws, piece.parent)?;
        let is_drawn = doubled_area(&piece.corners) != 0;
        is_drawn
            .then(|| {
                entry(
                    &VertexEvaluator::new(scene, draw, view, stack),
                    scene,
                    view,
                    geometry,
                    piece.parent,
                    Shown::ClippedTriangle(piece),
                    has_masks,
                )
            })
            .flatten()
    };
    (0..totals(scene, draws)[1] as u32).into_par_iter().map(whole).chain(geometry.pieces.par_iter().map(pieces))
}

/// What is drawn of a triangle.
enum Shown<'a> {
    EndToEnd(&'a [SnappedVertex; 3]),
    ClippedTriangle(&'a ClippedTriangle),
}

fn entry(
    vertex_evaluator: &VertexEvaluator,
    scene: &Scene,
    view: &View,
    geometry: &Geometry,
    id: u32,
    shown: Shown,
    has_masks: bool,
) -> Option<Entry> {
    let (corners, outline, piece) = match shown {
        Shown::EndToEnd(corners) => (corners, 7, None),
        Shown::ClippedTriangle(piece) => (&piece.corners, piece.outline, Some(&piece.corners)),
    };
    let draw = vertex_evaluator.draw;
    let primitive = &scene.primitives[draw.primitive];
    let vertices = primitive.corners(scene, id - draw.first_triangle);
    let [Ok(a), Ok(b), Ok(c)] = vertices.map(|vertex| bounded_place(scene, draw, vertex)) else { return None };
    let object = [a, b, c].map(|place| place.value);
    let places = vertices.map(|vertex| Corner { vertex, triangle: id - draw.first_triangle });
    let world = object.map(|position| draw.world_from_object.transform_point3(position));
    // Rounding errors are proportional to the sums of magnitudes, however much cancels.
    let m = draw.world_from_object;
    let reach = object.map(|p| m.x_axis.abs() * p.x.abs() + m.y_axis.abs() * p.y.abs() + m.z_axis.abs() * p.z.abs() + m.w_axis.abs());
    let reach = reach.iter().fold(0.0, |most: f64, axis| most.max(axis.truncate().max_element()));
    let deformed = [a, b, c].map(|p| (m.x_axis.abs() * p.error.x + m.y_axis.abs() * p.error.y + m.z_axis.abs() * p.error.z).max_element());
    let deformed = deformed.into_iter().fold(0.0, f64::max);
    let image = has_masks.then(|| mask::Places::of(vertex_evaluator, scene, view, places, piece)).flatten();
    let center = world.iter().sum::<DVec3>() / 3.0;
    let screen = || center_screen(vertex_evaluator, view, &corner_records(scene, draw, geometry, id), places);
    let setup = TriangleSetup {
        triangle: id,
        corners: corners.map(|corner| [corner.x, corner.y]),
        outline,
        size: [view.width, view.height],
        center,
        center_slack_m: 8.0 * ULP * reach + deformed,
        center_screen: vertex_evaluator.in_picture(center).unwrap_or_else(screen),
    };
    Some((setup, image.map(|image| (draw.primitive, image))))
}
