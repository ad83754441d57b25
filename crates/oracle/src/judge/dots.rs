//! Judges the dots that an adapter placed.

use rayon::prelude::*;

use super::super::{
    bounds::{
        dots::{BoundedDot, bounded_dots},
        snap::{ClipErrors, attributes_fit, snap_bound, whole_units},
    },
    render::{
        dots::{DotPlacement, dot_grid, snapped},
        snap::ClipPosition,
    },
    shot::Shot,
};
use crate::{
    effects::hooks::ROUNDING,
    frame::{SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    measure::ErrorReport,
    scene::{draw::DrawError, view::View},
};

/// Compares the records of dots with their bounds, and the strengths on pixels, which are integers,
/// with those that follow from the adapter's own records.
/// Errors: [`DrawError::TooMany`] for too many dots.
///
/// # Panics
/// If there are records of another scene.
pub fn judge_dots(
    report: &mut ErrorReport,
    shot: &Shot,
    records: &[SnappedVertex],
    strengths: &[u32],
    expected_strengths: &[u32],
) -> Result<(), DrawError> {
    let Some(dots) = shot.stack.dots() else {
        return Ok(());
    };
    let (bounded, grid) = (
        bounded_dots(&DotPlacement::new(shot, &dots)?),
        dot_grid(shot.view),
    );
    assert_eq!(
        records.len(),
        bounded.len(),
        "the dots are of another scene"
    );
    let is_outside = |(record, dot): &(&SnappedVertex, &Option<BoundedDot>)| {
        let own = snapped(dot.as_ref().map(|dot| &dot.position), &grid);
        !is_within(record, dot.as_ref(), &own, &grid)
    };
    report.dots = records.len() as u64;
    report.dots_outside_bound = records.par_iter().zip(&bounded).filter(is_outside).count() as u64;
    report.dot_pixels_wrong = strengths
        .iter()
        .zip(expected_strengths)
        .filter(|(a, b)| a != b)
        .count() as u64;
    report.dot_pixels_wrong += strengths.len().abs_diff(expected_strengths.len()) as u64;
    Ok(())
}

/// Returns true if a record lies within its bound. Also where rounding may move the dot anywhere,
/// or across a plane.
fn is_within(
    record: &SnappedVertex,
    dot: Option<&BoundedDot>,
    own: &SnappedVertex,
    grid: &View,
) -> bool {
    let Some(BoundedDot { position, errors }) = dot else {
        return record.flags == own.flags;
    };
    let ([_, _, ez, ew], ClipPosition { z, w, .. }) = (*errors, *position);
    let may_cross = (w - z).abs() <= ez + ew || z.abs() <= ez && z != 0.0 || w <= ew && w > -ew;
    let is_drawn = (record.flags | own.flags) & vertex_flags::NEAR == 0;
    let Some(bounds) = snap_bound(position, *errors, grid).filter(|_| w > 0.0) else {
        // If w is hardly known, a dot inside the near plane may lie anywhere in front of the eye.
        let is_in_front =
            record.inv_w > 0.0 && (0.0..=1.0 + 8.0 * ROUNDING).contains(&f64::from(record.depth));
        return may_cross
            || if is_drawn {
                is_in_front
            } else {
                record.flags == own.flags
            };
    };
    let bounds = bounds.map(whole_units);
    if record.flags != own.flags {
        let exact = unclamped(position, grid);
        let is_at_guard = exact
            .iter()
            .zip(bounds)
            .any(|(at, bound)| (at.abs() - f64::from(GUARD_BAND)).abs() <= bound + 1.0);
        return may_cross || is_drawn && is_at_guard;
    }
    if own.flags & vertex_flags::NEAR != 0 {
        return true;
    }
    let distances = [record.x.abs_diff(own.x), record.y.abs_diff(own.y)].map(f64::from);
    let is_near = own.flags != 0 || distances[0] <= bounds[0] && distances[1] <= bounds[1];
    is_near
        && attributes_fit(
            record,
            position,
            &ClipErrors {
                errors: *errors,
                magnitudes: [0.0, 0.0, z.abs(), w],
            },
        )
}

/// A position on the screen in sub-pixel units, however far outside.
fn unclamped(position: &ClipPosition, view: &View) -> [f64; 2] {
    let [half_x, half_y] = [view.width, view.height].map(|pixels| 128.0 * f64::from(pixels));
    [
        half_x + position.x / position.w * half_x,
        half_y - position.y / position.w * half_y,
    ]
}
