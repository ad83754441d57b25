//! Costs: time of a frame with an option as a fraction of the time with the default. A calibration measures it on the adapter; without one it is
//! as measured elsewhere (`docs/accuracy.md`, the price of exactness). Only options that are faster by more than the noise of a measurement are
//! chosen for speed.

use super::caps::Caps;
use crate::{
    accuracy::{AXES, AccuracyOptions, Axis, AxisOption, Coverage, DepthFormat, VertexTransform, Visibility},
    math::SMALL_EXTENT,
    scene::needs::Needs,
};

/// Options, by the index of their axis and their own, whose time a calibration measures beside that of the defaults.
pub const MEASURED_OPTIONS: [(usize, usize); 6] = [
    (Coverage::AXIS, Coverage::Fixed4 as usize),
    (Coverage::AXIS, Coverage::Fixed12 as usize),
    (Visibility::AXIS, Visibility::Packed32 as usize),
    (Visibility::AXIS, Visibility::Split32 as usize),
    (VertexTransform::AXIS, VertexTransform::Strict as usize),
    (DepthFormat::AXIS, DepthFormat::Integer as usize),
];

/// Triangles of the two scenes that are drawn with each of them.
pub const MEASURED_TRIANGLES: [u32; 2] = [200, 200_000];

/// Milliseconds of frames with options of [`MEASURED_OPTIONS`] and with the defaults, at [`MEASURED_TRIANGLES`], on one adapter; all above 0.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct OptionCosts {
    pub defaults_ms: [f64; 2],
    pub options_ms: [[f64; 2]; MEASURED_OPTIONS.len()],
}

/// What a calibration measured on an adapter that the planner asks for.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Measured {
    pub options: OptionCosts,
    /// Of [`super::Tuning`].
    pub max_small_samples: u32,
}

impl OptionCosts {
    /// Milliseconds of a frame of so many triangles with the same options: on the straight line through both scenes. Fewer triangles take as
    /// long as the first, and more never less than the second.
    fn ms([few, many]: [f64; 2], triangles: u64) -> f64 {
        let [first, last] = MEASURED_TRIANGLES.map(f64::from);
        let each = (many - few) / (last - first);
        let triangles = triangles as f64;
        few + each * (triangles.clamp(first, last) - first) + each.max(0.0) * (triangles - last).max(0.0)
    }

    /// Time of a frame of so many triangles with an option as a fraction of the time with the defaults; none for an option that is not
    /// measured. What may be noise is 1.
    pub fn fraction(&self, axis: usize, option: usize, triangles: u64) -> Option<f64> {
        let at = MEASURED_OPTIONS.iter().position(|measured| *measured == (axis, option))?;
        let fraction = Self::ms(self.options_ms[at], triangles) / Self::ms(self.defaults_ms, triangles);
        Some(if (fraction - 1.0).abs() < NOISE { 1.0 } else { fraction })
    }
}

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

/// A calibration's fraction that is nearer to 1 than this counts as 1: two of its frames differ by as much.
const NOISE: f64 = 0.03;

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Every option takes as long as the defaults, but one: half as long for the frame, twice as long for each triangle.
    fn with(axis: usize, option: usize) -> OptionCosts {
        let defaults_ms = [1.0, 1.0 + 199_800.0 * 1e-5];
        let mut costs = OptionCosts { defaults_ms, options_ms: [defaults_ms; MEASURED_OPTIONS.len()] };
        let at = MEASURED_OPTIONS.iter().position(|one| *one == (axis, option)).expect("it is measured");
        costs.options_ms[at] = [0.5, 0.5 + 199_800.0 * 2e-5];
        costs
    }

    #[test]
    fn what_was_measured_is_read_between_and_beyond_the_measured_numbers_of_triangles() {
        let packed = (Visibility::AXIS, Visibility::Packed32 as usize);
        let costs = with(packed.0, packed.1);
        let fraction = |triangles| costs.fraction(packed.0, packed.1, triangles).expect("it is measured");
        assert!((fraction(10) - 0.5).abs() < 1e-9 && (fraction(200) - 0.5).abs() < 1e-9);
        assert!((fraction(100_200) - 2.5 / 2.0).abs() < 1e-9);
        assert!(fraction(100_000_000) > 1.9);
        assert_eq!(costs.fraction(Visibility::AXIS, Visibility::Split32 as usize, 5000), Some(1.0));
        assert_eq!(costs.fraction(Visibility::AXIS, Visibility::Race as usize, 5000), None);
    }

    #[test]
    fn many_triangles_that_take_less_than_few_are_no_reason_to_expect_more_to_take_nothing() {
        let mut costs = with(Visibility::AXIS, Visibility::Packed32 as usize);
        (costs.defaults_ms, costs.options_ms[2]) = ([1.0, 0.5], [0.9, 0.4]);
        let fraction = |triangles| costs.fraction(Visibility::AXIS, Visibility::Packed32 as usize, triangles).expect("it is measured");
        assert!((fraction(200) - 0.9).abs() < 1e-9 && (fraction(200_000) - 0.8).abs() < 1e-9 && (fraction(1 << 40) - 0.8).abs() < 1e-9);
    }

    #[test]
    fn what_may_be_noise_saves_nothing() {
        let mut costs = with(Visibility::AXIS, Visibility::Packed32 as usize);
        costs.options_ms[2] = costs.defaults_ms.map(|ms| 0.98 * ms);
        assert_eq!(costs.fraction(Visibility::AXIS, Visibility::Packed32 as usize, 1000), Some(1.0));
    }
}
