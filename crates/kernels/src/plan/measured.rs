//! What a calibration measures for the planner: times of frames with accuracy options beside frames with the defaults, and how work is divided.

use crate::accuracy::{AxisOption, Coverage, DepthFormat, VertexTransform, Visibility};

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptionCosts {
    pub defaults_ms: [f64; 2],
    pub options_ms: [[f64; 2]; MEASURED_OPTIONS.len()],
}

/// What a calibration measured on an adapter that the planner asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    pub options: OptionCosts,
    /// Most samples of a triangle that one invocation walks.
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

/// A calibration's fraction that is nearer to 1 than this counts as 1: two of its frames differ by as much.
const NOISE: f64 = 0.05;

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
