//! Costs: time of a frame on a option as a share of its time on the usual one, as measured (README, the price of exactness).
//! Only what is cheaper by more than the noise of a measurement stands here; the rest gains nothing and is never chosen.

use super::Caps;
use crate::{
    accuracy::{AXES, Axis, AxisOption, Coverage, Visibility},
    math::SMALL_EXTENT,
    scene::needs::Needs,
};

/// Share of the usual time.
pub(super) fn of(axis: &Axis, place: usize, needs: &Needs, caps: &Caps) -> f64 {
    // On a coarser grid more triangles are small, so that most pictures need no kernel for large ones: that is the gain.
    let has_large = |option: Coverage| needs.largest_px >= f64::from(SMALL_EXTENT >> option.subpixel_bits());
    let is_fixed4 = axis.name == AXES[Coverage::AXIS].name && place == Coverage::Fixed4.place();
    if is_fixed4 && has_large(Coverage::Fixed8) && !has_large(Coverage::Fixed4) {
        return if caps.software { FIXED4_SOFTWARE } else { FIXED4_CARD };
    }
    let is_packed32 = axis.name == AXES[Visibility::AXIS].name && place == Visibility::Packed32.place();
    if is_packed32 && (caps.software || !caps.int64_atomics) { PACKED32 } else { 1.0 }
}

/// 1,000 and 100,000 triangles at 1920x1080 on lavapipe, 16 cores, 2026-11-21; on SwiftShader, against split32, less still. A
/// card with 64-bit atomics gains nothing.
const PACKED32: f64 = 0.87;

/// 1,000 triangles at 1920x1080 on an NVIDIA H200, 2026-11-21: 0.0675 ms against 0.0945.
const FIXED4_CARD: f64 = 0.72;

/// On lavapipe the kernel for large triangles costs hardly more than the others.
const FIXED4_SOFTWARE: f64 = 1.0;

/// Is the option worth leaving `from` for?
pub(super) fn saves(axis: &Axis, place: usize, from: usize, needs: &Needs, caps: &Caps) -> bool {
    of(axis, place, needs, caps) < of(axis, from, needs, caps)
}
