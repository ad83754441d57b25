//! Comparison of pictures in integers: no blur, no perceptual metric, no implicit tolerance.

/// Most mismatches that a comparison lists.
pub const MAX_MISMATCHES: usize = 16;

/// Difference of two pictures.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureDelta {
    /// Largest difference of any channel, of 255.
    pub max_delta: u8,
    /// Root mean square over all channels, of 255.
    pub rms: f64,
    /// Pixels with a channel that differs by more than the tolerance.
    pub pixels_over_tolerance: u64,
    /// The first of them, at most [`MAX_MISMATCHES`].
    pub mismatches: Vec<Mismatch<[u8; 4]>>,
}

/// A pixel that differs between two images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mismatch<T> {
    /// Index in the image, row-major.
    pub index: usize,
    pub a: T,
    pub b: T,
}

impl<T> Mismatch<T> {
    /// Column and row in an image `width` pixels wide.
    pub fn pixel(&self, width: u32) -> [usize; 2] {
        let width = width.max(1) as usize;
        [self.index % width, self.index / width]
    }
}

/// Compares two pictures of the same size; a pixel is over tolerance if a channel (including alpha)
/// differs by more than `max_channel`.
///
/// If one picture has more pixels, the surplus is over tolerance, with the largest difference.
pub fn pictures(a: &[[u8; 4]], b: &[[u8; 4]], max_channel: u8) -> PictureDelta {
    let mut delta = PictureDelta::default();
    let mut squares = 0u64;
    for (index, (&a, &b)) in a.iter().zip(b).enumerate() {
        let channels: [u8; 4] = std::array::from_fn(|c| a[c].abs_diff(b[c]));
        let largest = channels.into_iter().max().unwrap_or(0);
        squares += channels
            .iter()
            .map(|&d| u64::from(d) * u64::from(d))
            .sum::<u64>();
        delta.max_delta = delta.max_delta.max(largest);
        if largest > max_channel {
            delta.pixels_over_tolerance += 1;
            if delta.mismatches.len() < MAX_MISMATCHES {
                delta.mismatches.push(Mismatch { index, a, b });
            }
        }
    }
    let missing = a.len().abs_diff(b.len()) as u64;
    if missing > 0 {
        delta.max_delta = u8::MAX;
        delta.pixels_over_tolerance += missing;
        squares += missing * 4 * 255 * 255;
    }
    let channels = 4 * a.len().max(b.len()).max(1);
    delta.rms = (squares as f64 / channels as f64).sqrt();
    delta
}

/// Difference of two triangle id images.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TriangleDelta {
    /// Pixels with different triangle ids, including the surplus of a longer image.
    pub different: u64,
    /// The first of them, at most [`MAX_MISMATCHES`].
    pub mismatches: Vec<Mismatch<u32>>,
}

/// Compares two images of triangle ids, or of depth keys, of the same size.
pub fn triangle_ids(a: &[u32], b: &[u32]) -> TriangleDelta {
    let mismatches = a
        .iter()
        .zip(b)
        .enumerate()
        .filter(|(_, (a, b))| a != b)
        .map(|(index, (&a, &b))| Mismatch { index, a, b });
    let different = mismatches.clone().count() + a.len().abs_diff(b.len());
    TriangleDelta {
        different: different as u64,
        mismatches: mismatches.take(MAX_MISMATCHES).collect(),
    }
}

/// An opaque picture of the differences of two pictures: each channel's difference times `gain`,
/// black where they agree. A difference of alpha alone is gray.
pub fn difference_picture(a: &[[u8; 4]], b: &[[u8; 4]], gain: u8) -> Vec<[u8; 4]> {
    let pixel = |(a, b): (&[u8; 4], &[u8; 4])| {
        let [red, green, blue, alpha] =
            std::array::from_fn(|c| a[c].abs_diff(b[c]).saturating_mul(gain));
        if [red, green, blue] == [0; 3] {
            [alpha, alpha, alpha, 255]
        } else {
            [red, green, blue, 255]
        }
    };
    a.iter().zip(b).map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_beyond_its_budget_is_counted_and_named() {
        let a = vec![[10, 20, 30, 255]; 6];
        let mut b = a.clone();
        b[2][1] += 1;
        b[4][2] -= 2;
        let delta = pictures(&a, &b, 1);
        assert_eq!((delta.max_delta, delta.pixels_over_tolerance), (2, 1));
        assert_eq!(
            delta.mismatches,
            [Mismatch {
                index: 4,
                a: a[4],
                b: b[4]
            }]
        );
        assert_eq!(delta.mismatches[0].pixel(3), [1, 1]);
        assert!((delta.rms - (5.0f64 / 24.0).sqrt()).abs() < 1e-15);
        assert_eq!(pictures(&a, &b, 2).pixels_over_tolerance, 0);
    }

    #[test]
    fn alpha_is_a_channel_and_a_missing_pixel_is_a_difference() {
        assert_eq!(
            pictures(&[[1, 2, 3, 255]], &[[1, 2, 3, 250]], 4).pixels_over_tolerance,
            1
        );
        let short = pictures(&[[0; 4]; 3], &[[0; 4]; 2], 255);
        assert_eq!((short.max_delta, short.pixels_over_tolerance), (255, 1));
        assert_eq!(triangle_ids(&[1, 2, 3], &[1, 4]).different, 2);
    }

    #[test]
    fn difference_picture_is_black_exactly_where_pictures_agree() {
        let a = [[9, 9, 9, 255], [9, 9, 9, 255], [9, 9, 9, 255]];
        let b = [[9, 9, 9, 255], [9, 8, 200, 255], [9, 9, 9, 254]];
        assert_eq!(
            difference_picture(&a, &b, 16),
            [[0, 0, 0, 255], [0, 16, 255, 255], [16, 16, 16, 255]]
        );
    }
}
