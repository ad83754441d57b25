//! Forward error bounds of snapped records: how far a float renderer's position, depth and 1/w may
//! be from the exact ones (`docs/exactness.md` §9).

use glam::DVec3;

use super::super::render::snap::{ClipPosition, cell_units, from_center, half_size, nearest_cell};
use crate::{effects::hooks::ROUNDING, frame::SnappedVertex, scene::view::View};

/// Bounds of the errors of a clip-space position.
#[derive(Clone, Copy, Debug)]
pub struct ClipErrors {
    /// Of x, y, z and w.
    pub errors: [f64; 4],
    /// Sums of magnitudes of the terms of x, y, z and w.
    pub magnitudes: [f64; 4],
}

impl ClipErrors {
    /// Bounds of the errors of x, y and w.
    pub fn homogeneous(&self) -> DVec3 {
        let [x, y, _, w] = self.errors;
        DVec3::new(x, y, w)
    }
}

/// Bound of a snapped position before it is rounded, in sub-pixel units; none if w is not known to
/// a sixteenth, so that rounding may move the position anywhere.
pub fn snap_bound(
    position: &ClipPosition,
    [ex, ey, _, ew]: [f64; 4],
    view: &View,
) -> Option<[f64; 2]> {
    let w = position.w.abs();
    let [half_x, half_y] = half_size(view).map(f64::from);
    let bound =
        |half: f64, e: f64, c: f64| half * (e / w + (ew / w + 4.5 * ROUNDING) * (c / w).abs());
    (ew <= w / 16.0).then(|| [bound(half_x, ex, position.x), bound(half_y, ey, position.y)])
}

/// The largest distance in whole units between two snapped positions whose values before rounding
/// differ by a [`snap_bound`].
pub fn whole_units(bound: f64) -> f64 {
    if bound < 1.0 {
        1.0
    } else {
        (1.0 + bound).floor()
    }
}

/// Bounds of a position after it was rounded to cells of `cell_px` pixels, given those before. It
/// errs with w, which it is proportional to, and by a cell where the snapped position may lie on
/// either side of a cell's edge, or the corner on either side of the near plane, before which it is
/// not rounded.
pub fn on_grid(
    position: &ClipPosition,
    cell_px: u32,
    mut bounds: ClipErrors,
    view: &View,
) -> ClipErrors {
    let [_, _, ez, ew] = bounds.errors;
    let may_cross_near = (position.w - position.z).abs() <= ez + ew;
    let is_behind_near = position.z <= position.w && position.w > 0.0;
    // A place that is in doubt altogether is not judged.
    let (Some(reach), true) = (
        snap_bound(position, bounds.errors, view),
        is_behind_near || may_cross_near,
    ) else {
        return bounds;
    };
    let (cell, w) = (cell_units(cell_px, view), position.w.abs());
    for (axis, c) in [position.x, position.y].into_iter().enumerate() {
        let half = half_size(view)[axis].max(1);
        let place = from_center(c / position.w, half);
        let reach = whole_units(reach[axis]).min(f64::from(cell)) as i32;
        let [low, here, high] =
            [place - reach, place, place + reach].map(|place| nearest_cell(place, cell));
        let apart = if low == high && !may_cross_near {
            0
        } else {
            cell
        };
        let off_grid = if may_cross_near {
            bounds.errors[axis]
        } else {
            0.0
        };
        bounds.errors[axis] = off_grid
            + f64::from(here).abs() / f64::from(half) * (ew + 8.0 * ROUNDING * w)
            + f64::from(apart) / f64::from(half) * (w + ew);
    }
    bounds
}

/// Returns true if the depth and 1/w of a record lie within their bounds.
pub fn attributes_fit(
    record: &SnappedVertex,
    position: &ClipPosition,
    bounds: &ClipErrors,
) -> bool {
    let ([_, _, ez, ew], [_, _, sz, sw]) = (bounds.errors, bounds.magnitudes);
    let w = position.w.abs();
    let w_error = (ew + ROUNDING * sw) / w + 4.5 * ROUNDING;
    let depth_error =
        (ez + ROUNDING * sz) / w + (position.z / w).abs() * w_error + f64::from(f32::MIN_POSITIVE);
    (f64::from(record.inv_w) * position.w - 1.0).abs() <= w_error
        && (f64::from(record.depth) - position.z / position.w).abs() <= depth_error
}
