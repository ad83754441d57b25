//! Depth keys: integers that order as depths do (`docs/exactness.md` §6 and §10).

use crate::{
    frame::{DepthRounding, SnappedVertex},
    math::SMALL_EXTENT,
};

/// Bits of a depth rounded to f32, which order as the depths do; at least 1, because 0 marks an
/// empty pixel.
pub fn depth_key(depth: f64) -> u32 {
    if depth > 0.0 {
        (depth as f32).to_bits().max(1)
    } else {
        1
    }
}

/// Largest relative error of a float depth key: 8 or 12 steps of 2^-23, by the extent of the
/// triangle (`docs/exactness.md` §6).
pub fn depth_bound(corners: &[SnappedVertex; 3]) -> f64 {
    let extent = |at: [i32; 3]| at[0].max(at[1]).max(at[2]) - at[0].min(at[1]).min(at[2]);
    let is_small = extent(corners.map(|c| c.x)) <= SMALL_EXTENT
        && extent(corners.map(|c| c.y)) <= SMALL_EXTENT;
    (if is_small { 8.0 } else { 12.0 }) / f64::from(1 << 23)
}

/// Returns true if a key may stand for a depth in the interval.
pub fn key_fits(key: u32, rounding: &DepthRounding, [low, high]: [f64; 2]) -> bool {
    let [least, most] = rounding.depths(key);
    key != 0 && least <= high && most >= low
}

/// The depth key at a sample as a quotient of integers (`docs/exactness.md` §10), from the depths
/// of the corners and the doubled areas opposite them. It depends neither on the order of the
/// corners nor on the size class of the triangle.
pub fn integer_key(depths: [f32; 3], weights: [i64; 3]) -> u32 {
    // Subnormal and negative depths count as 0.
    let exponents = depths.map(|depth| {
        if depth >= f32::MIN_POSITIVE {
            depth.to_bits() >> 23
        } else {
            0
        }
    });
    let largest = exponents[0].max(exponents[1]).max(exponents[2]);
    // Fixed point: the leading bit of the nearest corner's significand becomes bit 31.
    let fixed = [0, 1, 2].map(|i| match (exponents[i], largest - exponents[i]) {
        (0, _) | (_, 32..) => 0,
        (_, shift) => u128::from(depths[i].to_bits() & 0x7f_ffff | 0x80_0000) << 8 >> shift,
    });
    let bits = 64 - weights.iter().sum::<i64>().leading_zeros();
    let weights = weights.map(|weight| weight as u128 >> bits.saturating_sub(31));
    let quotient =
        (0..3).map(|i| weights[i] * fixed[i]).sum::<u128>() / weights.iter().sum::<u128>();
    let quotient = u32::try_from(quotient).expect("a mean of 32-bit numbers has 32 bits");
    match largest.checked_sub(quotient.leading_zeros()) {
        Some(exponent @ 1..) if quotient > 0 => {
            exponent << 23 | quotient << quotient.leading_zeros() >> 8 & 0x7f_ffff
        }
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_the_bits_of_depths_that_all_corners_share() {
        for depth in [1.0f32, 0.3, 1e-20, f32::MIN_POSITIVE] {
            assert_eq!(
                integer_key([depth; 3], [7, 0, 5]),
                depth.to_bits(),
                "{depth}"
            );
            assert_eq!(
                integer_key([depth; 3], [1 << 47, 3, (1 << 47) - 9]),
                depth.to_bits(),
                "{depth}"
            );
        }
        assert_eq!(integer_key([0.5, 0.25, 0.0], [0, 0, 3]), 1);
        assert_eq!(integer_key([f32::MIN_POSITIVE / 2.0; 3], [1, 1, 1]), 1);
    }

    #[test]
    fn keys_lie_between_the_corners_and_follow_the_true_depth() {
        let mut word = 1u32;
        let mut dice = || {
            word = crate::math::hash(word);
            word
        };
        for _ in 0..20_000 {
            let depths = [0, 1, 2].map(|_| f32::from_bits(0x3a00_0000 + dice() % 0x0200_0000));
            let shift = dice() % 46;
            let weights =
                [0, 1, 2].map(|_| (i64::from(dice()) << 16 | i64::from(dice() & 0xffff)) >> shift);
            if weights.iter().sum::<i64>() == 0 {
                continue;
            }
            let key = integer_key(depths, weights);
            let low = depths.iter().copied().fold(1.0, f32::min);
            let high = depths.iter().copied().fold(0.0, f32::max);
            assert!(
                (low.to_bits()..=high.to_bits()).contains(&key),
                "{depths:?} {weights:?}"
            );
            let exact: f64 = (0..3)
                .map(|i| f64::from(depths[i]) * weights[i] as f64)
                .sum::<f64>()
                / weights.iter().sum::<i64>() as f64;
            assert!(
                (f64::from(f32::from_bits(key)) / exact - 1.0).abs()
                    < 12.0 * f64::from(f32::EPSILON),
                "{depths:?} {weights:?}"
            );
        }
    }
}
