//! Costs: time of a frame with an option as a fraction of the time with the default, as measured (`docs/accuracy.md`, the price
//! of exactness). Only options that are faster by more than the noise of a measurement are listed; no other is chosen for speed.

use super::caps::Caps;
use crate::{
    accuracy::{Axis, AxisOption, Coverage, Visibility},
    math::SMALL_EXTENT,
    scene::needs::Needs,
};

/// Fraction of the default's time.
pub(super) fn of(axis: &Axis, option: usize, needs: &Needs, caps: &Caps) -> f64 {
    match axis.index() {
        Coverage::AXIS if Coverage::from_index(option) == Coverage::Fixed4 => fixed4(needs, caps),
        Visibility::AXIS if Visibility::from_index(option) == Visibility::Packed32 => packed32(caps),
        _ => 1.0,
    }
}

/// On a coarser grid more triangles are small, so that most pictures need no kernel for large ones.
fn fixed4(needs: &Needs, caps: &Caps) -> f64 {
    let has_large = |option: Coverage| needs.largest_px >= f64::from(SMALL_EXTENT >> option.subpixel_bits());
    match (has_large(Coverage::Fixed8) && !has_large(Coverage::Fixed4), caps.software) {
        (false, _) => 1.0,
        (true, true) => FIXED4_SOFTWARE,
        (true, false) => FIXED4_CARD,
    }
}

/// A card with 64-bit atomics gains nothing.
fn packed32(caps: &Caps) -> f64 {
    if caps.software || !caps.int64_atomics { PACKED32 } else { 1.0 }
}

/// 1,000 and 100,000 triangles at 1920x1080 on lavapipe, 16 cores, 2026-11-21; on SwiftShader, against split32, less still.
const PACKED32: f64 = 0.87;

/// 1,000 triangles at 1920x1080 on an NVIDIA H200, 2026-11-21: 0.0675 ms against 0.0945.
const FIXED4_CARD: f64 = 0.72;

/// On lavapipe the kernel for large triangles costs hardly more than the others.
const FIXED4_SOFTWARE: f64 = 1.0;
