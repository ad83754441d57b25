//! ErrorMap: where a picture is wrong, pixel by pixel. The counts of an [`ErrorReport`](super::ErrorReport) say how often.

/// What may be the matter with a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelError {
    /// Its triangle id is wrong, outside every named band.
    TriangleId,
    /// Its triangle id is wrong and covers the sample: coverage is right, the comparison of depths is not.
    Depth,
    /// A triangle covers its sample and was not drawn there.
    Hole,
    /// A triangle was drawn there more often than it covers the sample.
    Double,
    /// Two triangle ids are right: their depths are closer than the bound of the depth key.
    Tie,
    /// Its depth, or a value at a corner of its triangle id, is NaN, infinite or negative by its bits.
    Unsound,
}

impl PixelError {
    pub const ALL: [Self; 6] = [Self::TriangleId, Self::Depth, Self::Hole, Self::Double, Self::Tie, Self::Unsound];

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// The map of a picture's faults. Row-major, top row first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorMap {
    marks: Vec<u8>,
    /// Largest difference of a colour channel from the right answer, of 255.
    pub colour: Vec<u8>,
}

impl ErrorMap {
    /// The map whose pixel `i` has the faults that `of` gives; colours are held against `right`.
    pub fn new(picture: &[[u8; 4]], right: &[[u8; 4]], of: impl Fn(usize) -> Vec<PixelError>) -> Self {
        let marks = (0..picture.len()).map(|i| of(i).into_iter().fold(0, |bits, fault| bits | fault.bit())).collect();
        let colour = picture.iter().zip(right).map(|(a, b)| largest(a, b)).collect();
        Self { marks, colour }
    }

    /// Where the triangle id is wrong, holds the colour against that of the right one.
    pub fn compare_again(&mut self, picture: &[[u8; 4]], right: &[[u8; 4]]) {
        for i in 0..self.marks.len() {
            if self.has(i, PixelError::TriangleId) {
                self.colour[i] = largest(&picture[i], &right[i]);
            }
        }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.marks.len()
    }

    pub fn has(&self, pixel: usize, fault: PixelError) -> bool {
        self.marks[pixel] & fault.bit() != 0
    }

    /// Pixels with a fault.
    pub fn count(&self, fault: PixelError) -> u64 {
        self.marks.iter().filter(|marks| *marks & fault.bit() != 0).count() as u64
    }

    /// Pixels whose colour differs at all.
    pub fn differing(&self) -> u64 {
        self.colour.iter().filter(|delta| **delta > 0).count() as u64
    }
}

fn largest(a: &[u8; 4], b: &[u8; 4]) -> u8 {
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

/// Is this f32 NaN, infinite or below zero? Told by its bits alone, since arithmetic may assume that none is.
pub const fn is_unsound(bits: u32) -> bool {
    is_nonfinite(bits) || bits > 0x8000_0000
}

/// Is this f32 NaN or infinite, by its bits?
pub const fn is_nonfinite(bits: u32) -> bool {
    bits & 0x7f80_0000 == 0x7f80_0000
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_tell_what_comparisons_may_not() {
        let unsound = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e-45, -1.0, f32::from_bits(0x7f80_0001)];
        let sound = [0.0, -0.0, 1e-45, 1.0, f32::MAX, f32::MIN_POSITIVE];
        assert!(unsound.iter().all(|v| is_unsound(v.to_bits())), "{unsound:?}");
        assert!(!sound.iter().any(|v| is_unsound(v.to_bits())), "{sound:?}");
        assert!(!is_nonfinite((-1.0f32).to_bits()));
    }

    #[test]
    fn a_wrong_owner_is_held_against_the_right_one_s_colour() {
        let picture = [[10, 10, 10, 255]; 3];
        let of = |i: usize| if i == 1 { vec![PixelError::TriangleId, PixelError::Depth] } else { Vec::new() };
        let mut faults = ErrorMap::new(&picture, &[[11, 10, 10, 255]; 3], of);
        assert_eq!((faults.colour.clone(), faults.differing(), faults.count(PixelError::Depth)), (vec![1, 1, 1], 3, 1));
        faults.compare_again(&picture, &[[10, 10, 90, 255]; 3]);
        assert_eq!(faults.colour, [1, 80, 1]);
        assert!(faults.has(1, PixelError::TriangleId) && !faults.has(1, PixelError::Hole) && !faults.has(0, PixelError::TriangleId));
    }
}
