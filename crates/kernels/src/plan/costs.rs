//! Costs: time of a frame with an option as a fraction of the time with the default. A calibration measures it on the adapter; without one it is
//! as measured elsewhere (`docs/accuracy.md`, the price of exactness). Only options that are faster by more than the noise of a measurement are
//! chosen for speed.

use super::caps::Caps;
use crate::{
    accuracy::{AXES, AccuracyOptions, Axis, AxisOption, Coverage, DepthFormat, VertexTransform, Visibility},
    math::SMALL_EXTENT,
    scene::needs::Needs,
};

/// Fraction of the default's time, at most 1: slower options are taken for their accuracy, never for their cost.
pub(super) fn of(axis: &Axis, option: usize, needs: &Needs, caps: &Caps) -> f64 {
    if option < axis.default { relative(axis, option, needs, caps).min(1.0) } else { 1.0 }
}

/// Time of a frame with these options as a fraction of the time with the defaults, as far as it was measured.
pub(super) fn expected(options: &AccuracyOptions, needs: &Needs, caps: &Caps) -> f64 {
    AXES.iter().map(|axis| relative(axis, options.get(axis), needs, caps)).product()
}

/// Fraction of the default's time: measured on this adapter, or else elsewhere; 1 where it was not measured.
fn relative(axis: &Axis, option: usize, needs: &Needs, caps: &Caps) -> f64 {
    let measured = || caps.measured.and_then(|measured| measured.options.fraction(axis.index(), option, needs.triangles));
    let elsewhere = || match axis.index() {
        Coverage::AXIS if Coverage::from_index(option) == Coverage::Fixed4 => fixed4(caps),
        Visibility::AXIS if Visibility::from_index(option) == Visibility::Packed32 => packed32(caps),
        DepthFormat::AXIS if DepthFormat::from_index(option) == DepthFormat::Integer => INTEGER_KEYS,
        VertexTransform::AXIS if VertexTransform::from_index(option) == VertexTransform::Strict => strict(needs, caps),
        _ => 1.0,
    };
    let is_coarse = axis.index() == Coverage::AXIS && Coverage::from_index(option) == Coverage::Fixed4;
    if is_coarse && !spares_large(needs) { 1.0 } else { measured().unwrap_or_else(elsewhere) }
}

/// On a coarser grid more triangles are small, so that most pictures need no kernel for large ones. Where they need none anyway, or one in spite
/// of it, nothing is gained.
fn spares_large(needs: &Needs) -> bool {
    let has_large = |option: Coverage| needs.largest_px >= f64::from(SMALL_EXTENT >> option.subpixel_bits());
    has_large(Coverage::Fixed8) && !has_large(Coverage::Fixed4)
}

fn fixed4(caps: &Caps) -> f64 {
    if caps.software { FIXED4_SOFTWARE } else { FIXED4_CARD }
}

/// A card with 64-bit atomics gains nothing.
fn packed32(caps: &Caps) -> f64 {
    if caps.software || !caps.int64_atomics { PACKED32 } else { 1.0 }
}

fn strict(needs: &Needs, caps: &Caps) -> f64 {
    match (needs.vertices >= MANY_VERTICES, caps.software) {
        (false, _) => STRICT_VERTICES,
        (true, true) => STRICT_MANY_SOFTWARE,
        (true, false) => STRICT_MANY_CARD,
    }
}

/// 1,000 and 100,000 triangles at 1920x1080 on lavapipe, 16 cores, 2026-11-21; on SwiftShader, against split32, less still.
const PACKED32: f64 = 0.87;

/// 1,000 triangles at 1920x1080 on an NVIDIA H200, 2026-11-21: 0.0675 ms against 0.0945.
const FIXED4_CARD: f64 = 0.72;

/// On lavapipe the kernel for large triangles costs hardly more than the others.
const FIXED4_SOFTWARE: f64 = 1.0;

/// Integer depth keys on an NVIDIA H200, at 1,000 to 10,000,000 triangles, 2026-11-22: 1.07 to 1.12; on lavapipe 1.07 to 1.14.
const INTEGER_KEYS: f64 = 1.10;

/// Strict vertices at 1,000 and 100,000 triangles on an NVIDIA H200 and on lavapipe, 2026-11-22: 1.03 to 1.07.
const STRICT_VERTICES: f64 = 1.06;

/// From about so many vertices on they take most of the time of a frame.
const MANY_VERTICES: u64 = 2_000_000;

/// Strict vertices at 10,000,000 triangles, 2026-11-22.
const STRICT_MANY_CARD: f64 = 2.57;
const STRICT_MANY_SOFTWARE: f64 = 1.24;
