//! Judges the sample setups of an adapter.

use glam::DVec3;
use rayon::prelude::*;

use super::super::{
    bounds::{mask, sample_setup::with_center_error, vertex::VertexBounds},
    render::{
        sample_setup::{SetupEntry, effects_with_setup, entries, mask_records},
        vertex::VertexEvaluator,
    },
    shot::Shot,
};
use crate::{
    effects::hooks::{ROUNDING, SampleHook, TriangleSetup},
    frame::Geometry,
    scene::draw::totals,
};

/// Number of setups that are wrong: a first word is outside its bound, or another word does not
/// follow from it.
///
/// # Panics
/// If `geometry` has setups of another scene or stack.
pub fn wrong_setups(shot: &Shot, geometry: &Geometry) -> u64 {
    let (effects, masks) = (
        effects_with_setup(shot.stack),
        mask_records(shot.scene, shot.stack),
    );
    let records = effects.len() + masks;
    if records == 0 {
        return 0;
    }
    let entries_of_scene =
        totals(shot.scene, shot.draws)[1] as usize + geometry.clipped_triangles.len();
    assert_eq!(
        geometry.sample_setups.len(),
        records * entries_of_scene,
        "the sample setups are of another scene"
    );
    let wrong = |(entry, given): (Option<SetupEntry>, &[[u32; 4]])| {
        let Some(SetupEntry {
            setup,
            is_clipped,
            mask,
        }) = entry
        else {
            return 0;
        };
        let mut setup = with_center_error(shot, setup);
        if is_clipped {
            setup.center_screen_error = center_screen_error(shot, setup.triangle);
        }
        let mask_is_wrong = match (masks, mask) {
            (0, _) => false,
            (_, None) => given[records - 1][2] != 0,
            (_, Some((_, coords))) => !mask::allows(
                &coords,
                &clip_errors(shot, setup.triangle),
                &given[effects.len()..],
            ),
        };
        let wrong = effects
            .iter()
            .zip(given)
            .filter(|(effect, given)| is_wrong(&setup, effect, **given))
            .count();
        (wrong + usize::from(mask_is_wrong)) as u64
    };
    entries(shot, geometry)
        .zip(geometry.sample_setups.par_chunks(records))
        .map(wrong)
        .sum()
}

/// How far the mean of a triangle's corners in clip space may be off in the picture, as a fraction
/// of it: a quotient whose divisor may cancel. Infinite where the mean may lie on either side of the
/// eye.
fn center_screen_error(shot: &Shot, id: u32) -> f64 {
    let draw = shot.draw_of(id).expect("a triangle of the shot");
    let evaluator = VertexEvaluator::new(shot.scene, draw, shot.view, shot.stack);
    let corners = evaluator.triangle_corners(id - draw.first_triangle);
    let clip = corners.map(|corner| evaluator.clip(corner).map(|p| DVec3::new(p.x, p.y, p.w)));
    let [Ok(a), Ok(b), Ok(c)] = clip else {
        return f64::INFINITY;
    };
    let rounding = 4.0 * ROUNDING * (a.abs() + b.abs() + c.abs());
    let (sum, error) = (
        a + b + c,
        clip_errors(shot, id).iter().sum::<DVec3>() + rounding,
    );
    if sum.z < -error.z {
        return 0.0;
    }
    let least = sum.z - error.z;
    if least <= 0.0 {
        return f64::INFINITY;
    }
    let across =
        |sum_of: f64, error_of: f64| 0.5 * (error_of + error.z * (sum_of / sum.z).abs()) / least;
    across(sum.x, error.x).max(across(sum.y, error.y))
}

/// Bounds of the errors of a triangle's corners in x, y and w of clip space.
fn clip_errors(shot: &Shot, id: u32) -> [DVec3; 3] {
    let draw = shot.draw_of(id).expect("a triangle of the shot");
    let evaluator = VertexEvaluator::new(shot.scene, draw, shot.view, shot.stack);
    let bounds = VertexBounds::new(&evaluator, None);
    evaluator
        .triangle_corners(id - draw.first_triangle)
        .map(|corner| bounds.clip(corner).homogeneous())
}

fn is_wrong(setup: &TriangleSetup, (hook, words): &(&SampleHook, &[u32]), given: [u32; 4]) -> bool {
    let reference = (hook.sample_setup)(setup, words, None);
    let is_near = f64::from(reference[0].abs_diff(given[0])) <= (hook.error_bound)(setup, words);
    !is_near || (hook.sample_setup)(setup, words, Some(given[0])) != given
}
