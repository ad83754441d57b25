//! X-ray: the average of all layers on a pixel instead of the nearest, in linear light and in whole
//! numbers.
//!
//! Every covered sample adds its weighted color and its weight to four integers; integers commute,
//! so the picture does not depend on the order in which samples arrive, to the bit.

use glam::{DVec3, DVec4};

use super::{BuiltIn, Effect, Surface, SurfaceInput, hooks::Slot};
use crate::{choice, words};

choice! {
    /// Which layers count.
    pub enum Reach {
        /// All of them.
        All,
        /// Those at most a window behind the front one.
        Window,
    }
}

choice! {
    /// Which layers have more weight.
    pub enum Weighting {
        /// All layers alike.
        Equal,
        /// Those that face the eye.
        Facing,
        /// Those that are seen edge-on, as a thin shell under real x-rays.
        Grazing,
        /// Near ones.
        Near,
    }
}

choice! {
    /// Bits per channel in the sums: the fewer, the more layers fit.
    pub enum Bits {
        /// As many as the scene's triangles leave room for, at least 12 to begin with.
        Auto,
        Sixteen,
        Twelve,
        Ten,
        Eight,
    }
}

words! {
    pub struct Xray of "xray" {
        layers: u32,
        window: u32,
        weight: u32,
        opacity: f32,
        bits: u32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Xray>()
    .in_slot(Slot::Visibility)
    .reading(&[
        SurfaceInput::Normal,
        SurfaceInput::View,
        SurfaceInput::Depth,
        SurfaceInput::DepthRange,
    ])
    .into()
});

/// Bits per channel that the sums may have, most first.
pub const CHANNEL_BITS: [u32; 4] = [16, 12, 10, 8];

/// Weight of a layer that counts in full, where layers have weights.
pub const FULL_WEIGHT: u32 = 255;

/// Sum of weights that sums of so many bits per channel hold without overflow.
pub const fn capacity(bits: u32) -> u32 {
    u32::MAX / ((1 << bits) - 1)
}

/// The next smaller number of bits after an overflow.
pub fn fewer(bits: u32) -> Option<u32> {
    CHANNEL_BITS.into_iter().find(|option| *option < bits)
}

impl Xray {
    /// Bits per channel to begin with, in a scene of so many triangles: as many as cannot overflow,
    /// 12 where none is safe.
    pub fn first_bits(&self, triangles: u64) -> u32 {
        match Bits::of(self.bits) {
            Bits::Auto
                if triangles.saturating_mul(self.unit().into()) <= u64::from(capacity(16)) =>
            {
                16
            }
            Bits::Auto | Bits::Twelve => 12,
            Bits::Sixteen => 16,
            Bits::Ten => 10,
            Bits::Eight => 8,
        }
    }

    /// Weight of a layer of full weight.
    pub fn unit(&self) -> u32 {
        if Weighting::of(self.weight) == Weighting::Equal {
            1
        } else {
            FULL_WEIGHT
        }
    }

    /// Weight of a layer before it is rounded, at most [`Self::unit`]; at least 1, so that every
    /// layer counts.
    pub fn weight_of(&self, s: &Surface) -> f64 {
        let facing = s.normal.dot(s.view).abs();
        let weight = match Weighting::of(self.weight) {
            Weighting::Equal => return 1.0,
            Weighting::Facing => facing,
            Weighting::Grazing => 1.0 - facing,
            Weighting::Near => {
                (s.depth_range_m.y - s.depth_m) / (s.depth_range_m.y - s.depth_range_m.x)
            }
        };
        (weight * f64::from(FULL_WEIGHT)).clamp(1.0, f64::from(FULL_WEIGHT))
    }

    /// Least depth key that counts on a pixel whose front has the key `front`. Integers alone:
    /// kernels do the same.
    ///
    /// In a perspective distances are quotients of depths: the significand times 1000/(1000 +
    /// window), of 16 bits. Where all rays are parallel depth is linear, and the window a
    /// number of its steps of 2^-20.
    pub fn threshold(&self, front: u32, is_perspective: bool) -> u32 {
        if Reach::of(self.layers) == Reach::All {
            return 1;
        }
        if !is_perspective {
            let step = (f32::from_bits(front) * 1_048_576.0) as u32;
            let least = step.saturating_sub((self.window << 20) / 1000);
            return (least as f32 / 1_048_576.0).to_bits().max(1);
        }
        let exponent = front >> 23;
        let significand = u64::from(front & 0x7f_ffff | 0x80_0000);
        let scaled = ((significand * u64::from(65_536_000 / (1000 + self.window))) >> 16) as u32;
        let shift = scaled.leading_zeros() - 8;
        if exponent <= shift {
            1
        } else {
            ((exponent - shift) << 23) | ((scaled << shift) & 0x7f_ffff)
        }
    }

    /// Color of a pixel: the average over the background, the denser the more layers it has.
    pub fn seen(&self, average: DVec3, background: DVec4, weight: f64) -> DVec4 {
        let clear = libm::pow(
            1.0 - f64::from(self.opacity),
            weight / f64::from(self.unit()),
        );
        let color = average + (background.truncate() - average) * clear;
        color.extend(1.0 + (background.w - 1.0) * clear)
    }
}

/// Sum over count, to the nearest whole number, halves up.
pub fn average(sum: u64, count: u64) -> u64 {
    let count = count.max(1);
    sum / count + u64::from(2 * (sum % count) >= count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capacities_are_the_published_ones() {
        assert_eq!(
            CHANNEL_BITS.map(capacity),
            [65_537, 1_048_832, 4_198_404, 16_843_009]
        );
    }

    #[test]
    fn averages_round_halves_up() {
        assert_eq!(
            [
                average(5, 2),
                average(4, 3),
                average(0, 0),
                average(u64::from(u32::MAX), 65_537)
            ],
            [3, 1, 0, 65_535]
        );
    }

    #[test]
    fn a_window_is_a_share_of_the_distance() {
        let window = |window| Xray {
            layers: Reach::Window as u32,
            window,
            ..Xray::default()
        };
        for front in [1.0f32, 0.7, 0.013, 1.0 / 3.0, 1e-6] {
            assert_eq!(
                window(0).threshold(front.to_bits(), true),
                front.to_bits(),
                "nothing but the front"
            );
            for n in [1, 10, 333, 1000, 4000] {
                let least = f64::from(f32::from_bits(window(n).threshold(front.to_bits(), true)));
                let expected = f64::from(front) * 1000.0 / f64::from(1000 + n);
                assert!(
                    (least / expected - 1.0).abs() < 1e-4,
                    "{front} {n}: {least} for {expected}"
                );
            }
        }
        assert_eq!(
            window(250).threshold(0.75f32.to_bits(), false),
            0.5f32.to_bits()
        );
        assert_eq!(
            window(900).threshold(0.5f32.to_bits(), false),
            1,
            "never beyond the end"
        );
        assert_eq!(
            Xray::default().threshold(1.0f32.to_bits(), true),
            1,
            "all layers"
        );
    }
}
