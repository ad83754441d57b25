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
    let offset = |ndc: f64, half: i32| {
        (ndc * f64::from(half))
            .round_ties_even()
            .clamp(-16_777_216.0, 16_777_216.0) as i32
    };
    with_guard_flags(
        half_x + offset(x / w, half_x),
        half_y - offset(y / w, half_y),
        (z / w) as f32,
        (1.0 / w) as f32,
    )
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
