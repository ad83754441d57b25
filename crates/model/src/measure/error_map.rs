//! The error map: what is wrong at each pixel of a picture. An [`ErrorReport`](super::ErrorReport)
//! has the counts.

/// What may be wrong at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelError {
    /// Its triangle id is wrong, outside every named band.
    WrongTriangle,
    /// Its triangle id is wrong although that triangle covers the sample: coverage is right, the
    /// comparison of depths is not.
    WrongDepthOrder,
    /// A triangle covers its sample and was not drawn there.
    Hole,
    /// A triangle was drawn there more often than it covers the sample.
    DoubleHit,
    /// Two triangle ids are right: their depths are closer than the bound of the depth key.
    DepthBand,
    /// Its depth, or a value at a corner of its triangle, is NaN, infinite or negative by its bits.
    Unsound,
}

impl PixelError {
    pub const ALL: [Self; 6] = [
        Self::WrongTriangle,
        Self::WrongDepthOrder,
        Self::Hole,
        Self::DoubleHit,
        Self::DepthBand,
        Self::Unsound,
    ];

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// What is wrong at each pixel of a picture. Row-major, top row first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorMap {
    /// A bit for each [`PixelError`].
    errors: Vec<u8>,
    /// Largest difference of a color channel from the nearest right answer, of 255.
    pub color_delta: Vec<u8>,
}

impl ErrorMap {
    /// The map whose pixel `i` has the errors `of(i)`; colors are compared with `expected`.
    pub fn new(
        picture: &[[u8; 4]],
        expected: &[[u8; 4]],
        of: impl Fn(usize) -> Vec<PixelError>,
    ) -> Self {
        let errors = (0..picture.len())
            .map(|i| of(i).into_iter().fold(0, |bits, error| bits | error.bit()))
            .collect();
        let color_delta = picture
            .iter()
            .zip(expected)
            .map(|(a, b)| largest_delta(a, b))
            .collect();
        Self {
            errors,
            color_delta,
        }
    }

    /// The map of these bits, as [`ErrorMap::bits`] gives them, and these differences of colors.
    pub fn of_bits(errors: Vec<u8>, color_delta: Vec<u8>) -> Self {
        Self {
            errors,
            color_delta,
        }
    }

    /// A bit for each [`PixelError`] at each pixel.
    pub fn bits(&self) -> &[u8] {
        &self.errors
    }

    /// Where the triangle id is wrong, compares colors with `expected`, those of the right
    /// triangle.
    pub fn compare_again(&mut self, picture: &[[u8; 4]], expected: &[[u8; 4]]) {
        for i in 0..self.errors.len() {
            if self.has(i, PixelError::WrongTriangle) {
                self.color_delta[i] = largest_delta(&picture[i], &expected[i]);
            }
        }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.errors.len()
    }

    pub fn has(&self, pixel: usize, error: PixelError) -> bool {
        self.errors[pixel] & error.bit() != 0
    }

    /// Number of pixels with an error.
    pub fn count(&self, error: PixelError) -> u64 {
        self.errors
            .iter()
            .filter(|errors| *errors & error.bit() != 0)
            .count() as u64
    }

    /// Number of pixels whose color differs at all.
    pub fn differing(&self) -> u64 {
        self.color_delta.iter().filter(|delta| **delta > 0).count() as u64
    }
}

/// Largest difference of a channel.
fn largest_delta(a: &[u8; 4], b: &[u8; 4]) -> u8 {
    a.iter()
        .zip(b)
        .map(|(a, b)| a.abs_diff(*b))
        .max()
        .unwrap_or(0)
}

/// Returns true if an f32 is NaN, infinite or negative, by its bits alone: compilers may assume
/// that no float is NaN.
pub const fn is_unsound(bits: u32) -> bool {
    is_nonfinite(bits) || bits > 0x8000_0000
}

/// Returns true if an f32 is NaN or infinite, by its bits alone.
pub const fn is_nonfinite(bits: u32) -> bool {
    bits & 0x7f80_0000 == 0x7f80_0000
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_tell_what_comparisons_may_not() {
        let unsound = [
            f32::NAN,
            -f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            -1e-45,
            -1.0,
            f32::from_bits(0x7f80_0001),
        ];
        let sound = [0.0, -0.0, 1e-45, 1.0, f32::MAX, f32::MIN_POSITIVE];
        assert!(
            unsound.iter().all(|v| is_unsound(v.to_bits())),
            "{unsound:?}"
        );
        assert!(!sound.iter().any(|v| is_unsound(v.to_bits())), "{sound:?}");
        assert!(!is_nonfinite((-1.0f32).to_bits()));
    }

    #[test]
    fn a_wrong_owner_is_held_against_the_right_one_s_color() {
        let picture = [[10, 10, 10, 255]; 3];
        let of = |i: usize| {
            if i == 1 {
                vec![PixelError::WrongTriangle, PixelError::WrongDepthOrder]
            } else {
                Vec::new()
            }
        };
        let mut faults = ErrorMap::new(&picture, &[[11, 10, 10, 255]; 3], of);
        assert_eq!(
            (
                faults.color_delta.clone(),
                faults.differing(),
                faults.count(PixelError::WrongDepthOrder)
            ),
            (vec![1, 1, 1], 3, 1)
        );
        faults.compare_again(&picture, &[[10, 10, 90, 255]; 3]);
        assert_eq!(faults.color_delta, [1, 80, 1]);
        assert!(
            faults.has(1, PixelError::WrongTriangle)
                && !faults.has(1, PixelError::Hole)
                && !faults.has(0, PixelError::WrongTriangle)
        );
    }
}
