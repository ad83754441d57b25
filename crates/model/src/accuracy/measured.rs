//! What the options that the planner takes for their speed cost on the adapter at hand, as far as
//! that was measured.

use super::{AXES, AccuracyOptions, AxisOption, Coverage, Visibility};

/// Options that may be taken for their speed, by the index of their axis and their own.
const FASTER: [(usize, usize); 2] = [
    (Coverage::AXIS, Coverage::Fixed4 as usize),
    (Visibility::AXIS, Visibility::Packed32 as usize),
];

/// A fraction that is nearer to 1 than this counts as 1: two frames of one picture differ by as
/// much.
const NOISE: f64 = 0.05;

/// Times of frames with options that may be taken for their speed, as fractions of the time
/// without, on one adapter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuredCosts([Option<f64>; FASTER.len()]);

impl MeasuredCosts {
    /// Time of a frame with an option as a fraction of the time without; none where it was not
    /// measured.
    pub fn fraction(&self, axis: usize, option: usize) -> Option<f64> {
        self.0[FASTER.iter().position(|faster| *faster == (axis, option))?]
    }

    /// Takes in the milliseconds of frames of one picture with several options, each above 0: two
    /// of them that differ in one option tell what it costs. What is known already stays, so
    /// that a picture is not planned in another way each time it is measured.
    pub fn learn(&mut self, frames: &[(AccuracyOptions, f64)]) {
        for (known, (axis, option)) in self.0.iter_mut().zip(FASTER) {
            let twin = |(with, _): &(AccuracyOptions, f64)| {
                frames.iter().find(|(without, _)| {
                    let mut changed = *without;
                    changed.set(&AXES[axis], option);
                    changed == *with && without != with
                })
            };
            let fraction = frames
                .iter()
                .find_map(|frame| Some(frame.1 / twin(frame)?.1));
            *known = known.or(fraction.map(|fraction| {
                if (fraction - 1.0).abs() < NOISE {
                    1.0
                } else {
                    fraction
                }
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::DepthFormat;

    fn packed32_after(frames: &[(AccuracyOptions, f64)]) -> Option<f64> {
        let mut costs = MeasuredCosts::default();
        costs.learn(frames);
        costs.fraction(Visibility::AXIS, Visibility::Packed32.index())
    }

    #[test]
    fn pictures_that_differ_in_one_option_tell_what_it_costs() {
        let default = AccuracyOptions::default();
        let packed32 = AccuracyOptions {
            visibility: Visibility::Packed32,
            ..default
        };
        let integer = AccuracyOptions {
            depth: DepthFormat::Integer,
            ..default
        };
        let both = AccuracyOptions {
            coverage: Coverage::Fixed4,
            ..packed32
        };
        assert_eq!(
            packed32_after(&[(packed32, 8.0), (integer, 16.0), (default, 10.0)]),
            Some(0.8)
        );
        assert_eq!(
            packed32_after(&[(default, 10.0), (packed32, 9.8)]),
            Some(1.0),
            "that may be noise"
        );
        assert_eq!(
            packed32_after(&[(default, 10.0), (both, 5.0)]),
            None,
            "two options differ"
        );
        assert_eq!(packed32_after(&[(packed32, 5.0)]), None);
        assert_eq!(
            MeasuredCosts::default().fraction(DepthFormat::AXIS, DepthFormat::Integer.index()),
            None,
            "never taken for its speed"
        );
    }

    #[test]
    fn what_is_known_stays() {
        let default = AccuracyOptions::default();
        let packed32 = AccuracyOptions {
            visibility: Visibility::Packed32,
            ..default
        };
        let mut costs = MeasuredCosts::default();
        costs.learn(&[(default, 10.0), (packed32, 12.0)]);
        costs.learn(&[(default, 10.0), (packed32, 5.0)]);
        assert_eq!(
            costs.fraction(Visibility::AXIS, Visibility::Packed32.index()),
            Some(1.2)
        );
    }
}
