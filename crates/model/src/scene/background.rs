//! Backgrounds: what a picture shows where nothing is drawn.

use crate::math::srgb_byte;

/// One color, or a vertical gradient that is interpolated in linear light. Pictures hold it in
/// whole bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Background {
    /// Linear RGBA at the top edge of the picture.
    pub top: [f32; 4],
    /// Linear RGBA at the bottom edge.
    pub bottom: [f32; 4],
}

impl From<[f32; 4]> for Background {
    fn from(color: [f32; 4]) -> Self {
        Self {
            top: color,
            bottom: color,
        }
    }
}

impl Background {
    /// Do the rows of a picture differ?
    pub fn is_gradient(&self) -> bool {
        self.top != self.bottom
    }

    /// Gamma-encoded RGBA bytes of the pixels in row `y` of a picture of `height` rows. Row 0 is at
    /// the top. The position of a row is that of its pixel centers, `(y + 0.5) / height` of the
    /// way from the top edge to the bottom edge.
    pub fn row(&self, y: u32, height: u32) -> [u8; 4] {
        let t = (f64::from(y) + 0.5) / f64::from(height.max(1));
        let [r, g, b, alpha] = [0, 1, 2, 3].map(|c| {
            let [top, bottom] = [self.top[c], self.bottom[c]].map(f64::from);
            top + (bottom - top) * t
        });
        [
            srgb_byte(r),
            srgb_byte(g),
            srgb_byte(b),
            (alpha.clamp(0.0, 1.0) * 255.0 + 0.5).floor() as u8,
        ]
    }

    /// [`Background::row`] of all rows of a picture, top to bottom.
    pub fn rows(&self, height: u32) -> Vec<[u8; 4]> {
        if self.is_gradient() {
            (0..height).map(|y| self.row(y, height)).collect()
        } else {
            vec![self.row(0, 1); height as usize]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::linear_light;

    #[test]
    fn one_color_is_the_same_bytes_in_every_row() {
        for color in [
            [0.012, 0.014, 0.02, 1.0],
            [0.3, 0.1, 0.7, 0.501],
            [0.0, 1.0, 0.5, 0.0],
        ] {
            let plain = Background::from(color);
            assert!(!plain.is_gradient());
            let expected = [0, 1, 2].map(|c| srgb_byte(f64::from(color[c])));
            for row in plain.rows(7) {
                assert_eq!(row[..3], expected);
                assert_eq!(
                    row,
                    plain.row(3, 5),
                    "interpolation between equal colors is exact"
                );
            }
        }
    }

    #[test]
    fn a_gradient_is_linear_in_light_and_never_reaches_the_edges_colors_before_the_edges() {
        let gradient = Background {
            top: [0.0, 1.0, 0.25, 1.0],
            bottom: [1.0, 0.0, 0.25, 0.0],
        };
        for height in [1, 2, 5, 480] {
            let rows = gradient.rows(height);
            assert_eq!(rows.len(), height as usize);
            for (y, row) in rows.iter().enumerate() {
                let t = (2 * y + 1) as f64 / f64::from(2 * height);
                // Half a step of a byte, in light: the curve is steepest at the light end, where a
                // byte is 1/112.
                assert!(
                    (linear_light(f64::from(row[0]) / 255.0) - t).abs() <= 1.0 / 220.0,
                    "row {y} of {height}: {row:?}"
                );
                assert!(
                    (linear_light(f64::from(row[1]) / 255.0) - (1.0 - t)).abs() <= 1.0 / 220.0,
                    "row {y} of {height}: {row:?}"
                );
                assert_eq!(row[2], srgb_byte(0.25));
                assert!(
                    (f64::from(row[3]) / 255.0 - (1.0 - t)).abs() <= 0.501 / 255.0,
                    "row {y} of {height}: {row:?}"
                );
            }
            assert!(
                rows.is_sorted_by(|a, b| a[0] <= b[0] && a[1] >= b[1]),
                "{rows:?}"
            );
        }
        assert_eq!(
            gradient.rows(1)[0][0],
            srgb_byte(0.5),
            "a picture of one row shows the middle"
        );
        assert!(gradient.rows(0).is_empty());
    }
}
