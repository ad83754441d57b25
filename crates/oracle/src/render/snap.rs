//! Perspective division and the snap to the sub-pixel grid (`docs/exactness.md` §2).

use crate::{
    frame::{SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    scene::view::View,
};

/// Homogeneous clip-space position (WebGPU: y up, z from 0 to w; depth is reversed).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipPosition {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

/// The record of a vertex: only [`vertex_flags::NEAR`] between the eye and the near plane,
/// otherwise position, depth and 1/w.
///
/// Positions are rounded relative to the center of the picture and to even, so mirror images snap
/// to mirror images.
pub fn snap(position: &ClipPosition, view: &View) -> SnappedVertex {
    if position.z <= position.w && position.w > 0.0 {
        snap_inside(position, view)
    } else {
        SnappedVertex {
            flags: vertex_flags::NEAR,
            ..Default::default()
        }
    }
}

/// The record of a position that is not clipped by the near plane.
pub fn snap_inside(&ClipPosition { x, y, z, w }: &ClipPosition, view: &View) -> SnappedVertex {
    let [half_x, half_y] = half_size(view);
    with_guard_flags(
        half_x + from_center(x / w, half_x),
        half_y - from_center(y / w, half_y),
        (z / w) as f32,
        (1.0 / w) as f32,
    )
}

/// A place in units from the center of the picture, given half the picture in units.
pub fn from_center(ndc: f64, half: i32) -> i32 {
    (ndc * f64::from(half))
        .round_ties_even()
        .clamp(-16_777_216.0, 16_777_216.0) as i32
}

/// The corner of a cell of `cell` units that is nearest to a place, both from the center of the
/// picture.
pub const fn nearest_cell(place: i32, cell: i32) -> i32 {
    (place + cell / 2).div_euclid(cell) * cell
}

/// Side of a cell of so many pixels, in units; at least 1.
pub fn cell_units(cell_px: u32, view: &View) -> i32 {
    (view.units_per_pixel() * cell_px as i32).max(1)
}

/// The position at the nearest corner of a grid of cells of `cell_px` pixels that begins at the
/// center of the picture. Without cells, and before the near plane, it stays.
pub fn on_grid(position: ClipPosition, cell_px: u32, view: &View) -> ClipPosition {
    let ClipPosition { x, y, z, w } = position;
    if cell_px == 0 || z > w || w <= 0.0 {
        return position;
    }
    let cell = cell_units(cell_px, view);
    let rounded = |c: f64, half: i32| {
        f64::from(nearest_cell(from_center(c / w, half), cell)) / f64::from(half.max(1)) * w
    };
    let [half_x, half_y] = half_size(view);
    ClipPosition {
        x: rounded(x, half_x),
        y: rounded(y, half_y),
        z,
        w,
    }
}

/// A record with a flag for each side of the guard band that it lies beyond.
pub fn with_guard_flags(x: i32, y: i32, depth: f32, inv_w: f32) -> SnappedVertex {
    let beyond = [
        x < -GUARD_BAND,
        x > GUARD_BAND,
        y < -GUARD_BAND,
        y > GUARD_BAND,
    ];
    let flags = (0..4)
        .filter(|&side| beyond[side])
        .fold(0, |flags, side| flags | vertex_flags::GUARD[side]);
    SnappedVertex {
        x,
        y,
        depth,
        inv_w,
        flags,
    }
}

/// Half the picture in sub-pixel units: the position of its center, and units per unit of
/// normalized device coordinates.
pub fn half_size(view: &View) -> [i32; 2] {
    [view.width, view.height].map(|pixels| view.units_per_pixel() / 2 * pixels as i32)
}
