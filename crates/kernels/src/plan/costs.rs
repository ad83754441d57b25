//! Costs: time of a frame with an option as a fraction of the time with the default: measured on
//! this adapter, or else on others of its kind (`docs/accuracy.md`, the price of exactness). Only
//! options that are faster by more than the noise of a measurement are chosen for speed.

use super::caps::Caps;
use crate::{
    accuracy::{Axis, AxisOption, Coverage, MeasuredCosts, Visibility},
    math::SMALL_EXTENT,
    scene::needs::Needs,
};

/// Fraction of the default's time, at most 1: slower options are taken for their accuracy, never
/// for their cost.
pub(super) fn of(
    axis: &Axis,
    option: usize,
    needs: &Needs,
    caps: &Caps,
    measured: &MeasuredCosts,
) -> f64 {
    let elsewhere = match axis.index() {
        Coverage::AXIS if option == Coverage::Fixed4.index() => {
            if !spares_large(needs) {
                return 1.0;
            }
            if caps.software {
                FIXED4_SOFTWARE
            } else {
                FIXED4_CARD
            }
        }
        // A card with 64-bit atomics gains nothing.
        Visibility::AXIS
            if option == Visibility::Packed32.index() && (caps.software || !caps.int64_atomics) =>
        {
            PACKED32
        }
        _ => 1.0,
    };
    measured
        .fraction(axis.index(), option)
        .unwrap_or(elsewhere)
        .min(1.0)
}

/// On a coarser grid more triangles are small, so that most pictures need no kernel for large ones.
/// Where they need none anyway, or one in spite of it, nothing is gained.
fn spares_large(needs: &Needs) -> bool {
    let has_large =
        |option: Coverage| needs.largest_px >= f64::from(SMALL_EXTENT >> option.subpixel_bits());
    has_large(Coverage::Fixed8) && !has_large(Coverage::Fixed4)
}

/// 1,000 and 100,000 triangles at 1920x1080 on lavapipe, 16 cores, 2026-11-21; on SwiftShader,
/// against split32, less still.
const PACKED32: f64 = 0.87;

/// 1,000 triangles at 1920x1080 on an NVIDIA H200, 2026-11-21: 0.0675 ms against 0.0945.
const FIXED4_CARD: f64 = 0.72;

/// On lavapipe the kernel for large triangles costs hardly more than the others.
const FIXED4_SOFTWARE: f64 = 1.0;
