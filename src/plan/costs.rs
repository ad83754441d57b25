//! Costs: time of a frame with an option as a fraction of the time with the default, as measured (`docs/accuracy.md`, the price
//! of exactness). Only options that are faster by more than the noise of a measurement are listed; no other is chosen for speed.

use super::caps::Caps;
use crate::{
    accuracy::{AXES, AccuracyOptions, Axis, AxisOption, Coverage, DepthFormat, VertexTransform, Visibility},
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

/// Time of a frame with these options as a fraction of the time with the defaults, as far as it was measured. The slower options in it are
/// taken for their accuracy, never for their cost.
pub(super) fn expected(options: &AccuracyOptions, needs: &Needs, caps: &Caps) -> f64 {
    let cheaper = AXES.iter().map(|axis| of(axis, options.get(axis), needs, caps).min(1.0)).product::<f64>();
    let keys = if options.depth == DepthFormat::Integer { INTEGER_KEYS } else { 1.0 };
    let is_strict = options.vertex_transform == VertexTransform::Strict;
    let vertices = match is_strict.then_some((needs.vertices >= MANY_VERTICES, caps.software)) {
        None => 1.0,
        Some((false, _)) => STRICT_VERTICES,
        Some((true, true)) => STRICT_MANY_SOFTWARE,
        Some((true, false)) => STRICT_MANY_CARD,
    };
    cheaper * keys * vertices
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

/// Integer depth keys on an NVIDIA H200, at 1,000 to 10,000,000 triangles, 2026-11-22: 1.07 to 1.12; on lavapipe 1.07 to 1.14.
const INTEGER_KEYS: f64 = 1.10;

/// Strict vertices at 1,000 and 100,000 triangles on an NVIDIA H200 and on lavapipe, 2026-11-22: 1.03 to 1.07.
const STRICT_VERTICES: f64 = 1.06;

/// From about so many vertices on they take most of the time of a frame.
const MANY_VERTICES: u64 = 2_000_000;

/// Strict vertices at 10,000,000 triangles, 2026-11-22.
const STRICT_MANY_CARD: f64 = 2.57;
const STRICT_MANY_SOFTWARE: f64 = 1.24;
