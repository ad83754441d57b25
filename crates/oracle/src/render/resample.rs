//! Resampling of pictures that are drawn with more or fewer pixels than they are shown with.

use rayon::prelude::*;

use crate::frame::{LightSum, linear_bytes};

/// A picture at another size, in linear light: the mean of square blocks of pixels if it shrinks by
/// a whole factor, otherwise bilinear.
pub fn resampled(color: &[[u8; 4]], from: [u32; 2], to: [u32; 2]) -> Vec<[u8; 4]> {
    let light = linear_bytes();
    let side = from[0] / to[0].max(1);
    let is_whole = side > 1 && [0, 1].iter().all(|&axis| from[axis] == side * to[axis]);
    let pixel = |x: u32, y: u32| {
        let mut sum = LightSum::default();
        let mut add = |x: u32, y: u32, weight: f64| {
            sum.add(&color[(y * from[0] + x) as usize], weight, &light)
        };
        if is_whole {
            let weight = 1.0 / f64::from(side * side);
            (0..side * side).for_each(|i| add(x * side + i % side, y * side + i / side, weight));
        } else {
            // The two nearest rows or columns with their weights.
            let nearest = |at: u32, axis: usize| {
                // In half pixels of the larger picture, so that a pixel on another takes exactly
                // nothing from its neighbors.
                let (from, to) = (u64::from(from[axis]), u64::from(to[axis]));
                let halves = (2 * u64::from(at) + 1) * from + to;
                let (behind, rest) = (halves / (2 * to), halves % (2 * to));
                let fraction = rest as f64 / (2 * to) as f64;
                [
                    (behind.max(1) as u32 - 1, 1.0 - fraction),
                    (behind.min(from - 1) as u32, fraction),
                ]
            };
            let columns = nearest(x, 0);
            for (y, by_row) in nearest(y, 1) {
                columns
                    .iter()
                    .for_each(|&(x, by_column)| add(x, y, by_row * by_column));
            }
        }
        sum.bytes()
    };
    (0..to[1])
        .into_par_iter()
        .flat_map_iter(|y| {
            (0..to[0])
                .map(move |x| (x, y))
                .map(|(x, y)| pixel(x, y))
                .collect::<Vec<_>>()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::linear_light;

    #[test]
    fn an_even_picture_does_not_change_and_means_are_taken_in_linear_light() {
        let even = vec![[10, 200, 77, 255]; 12];
        assert_eq!(
            resampled(&even, [4, 3], [9, 2]),
            vec![[10, 200, 77, 255]; 18]
        );
        let halves = vec![
            [0, 0, 0, 255],
            [255, 255, 255, 255],
            [0, 0, 0, 255],
            [255, 255, 255, 255],
        ];
        // Half of the light is encoded as 188, not as 128.
        assert_eq!(resampled(&halves, [2, 2], [1, 1]), [[188, 188, 188, 255]]);
    }

    #[test]
    fn transparent_pixels_add_no_color() {
        let edge = vec![
            [255, 0, 0, 255],
            [0, 255, 0, 0],
            [255, 0, 0, 255],
            [0, 255, 0, 0],
        ];
        assert_eq!(resampled(&edge, [2, 2], [1, 1]), [[255, 0, 0, 128]]);
        assert_eq!(
            resampled(&[[9, 8, 7, 0]; 4], [2, 2], [1, 1]),
            [[9, 8, 7, 0]]
        );
    }

    #[test]
    fn a_pixel_on_another_takes_nothing_from_its_neighbors() {
        for side in [1, 3, 49, 1_001] {
            let row: Vec<[u8; 4]> = (0..side)
                .map(|x| {
                    if x == side / 2 {
                        [9, 8, 7, 0]
                    } else {
                        [255; 4]
                    }
                })
                .collect();
            let wide = resampled(&row, [side, 1], [2 * side - 1, 1]);
            assert_eq!(wide[side as usize - 1], [9, 8, 7, 0], "{side}");
        }
    }

    #[test]
    fn between_two_pixels_light_changes_evenly() {
        let [a, b] = [[0, 0, 0, 255], [255, 255, 255, 255]];
        let wide = resampled(&[a, b], [2, 1], [8, 1]);
        let light: Vec<f64> = wide
            .iter()
            .map(|pixel| linear_light(f64::from(pixel[0]) / 255.0))
            .collect();
        assert_eq!((wide[0], wide[7]), (a, b));
        assert!(
            light
                .windows(2)
                .all(|pair| (0.0..0.26).contains(&(pair[1] - pair[0]))),
            "{light:?}"
        );
    }
}
