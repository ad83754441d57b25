//! Rows of triangles: how many rows of samples are visited by what examines a triangle row by row, estimated from its area.

/// Rows of samples inside the picture that the box of a triangle covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TriangleRows {
    all: f32,
    /// Rows from the first to that of the second sample that the triangle covers, as its area lets one expect.
    first: f32,
    /// The most such rows, in almost all cases.
    most_first: f32,
}

/// Estimated rows that are visited by what examines the samples of triangles row by row.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct RowWork {
    /// Rows of all triangles.
    pub all: f64,
    /// The most rows of one triangle.
    pub most: f64,
    /// Rows of all triangles until each covers a second sample.
    pub first: f64,
    /// The most of these of one triangle among many.
    pub most_first: f64,
}

impl RowWork {
    /// Of sampled triangles that stand for `each` of the scene.
    pub(super) fn of(rows: &[TriangleRows], each: f64) -> Self {
        rows.iter().fold(Self::default(), |sum, rows| Self {
            all: sum.all + each * f64::from(rows.all),
            most: sum.most.max(rows.all.into()),
            first: sum.first + each * f64::from(rows.first),
            most_first: sum.most_first.max(rows.most_first.into()),
        })
    }
}

impl TriangleRows {
    /// The rows of a triangle whose corners lie at the heights `[top, middle, bottom]`, and which is `width` wide at the middle one. The picture
    /// shows it from the height `first` to `last`. All are pixels; heights grow downward.
    pub(super) fn of([top, middle, bottom]: [f64; 3], width: f64, [first, last]: [f64; 2]) -> Self {
        let (upper, lower) = ((middle - top).max(1e-9), (bottom - middle).max(1e-9));
        let area = 0.5 * width * (bottom - top);
        // Square pixels above a height, and the height above which there are so many.
        let above = |y: f64| match y {
            y if y <= middle => 0.5 * width * (y - top).max(0.0).powi(2) / upper,
            y => area - 0.5 * width * (bottom - y).max(0.0).powi(2) / lower,
        };
        let height = |above: f64| match above {
            above if above >= area => bottom,
            above if above <= 0.5 * width * upper => top + (2.0 * above * upper / width).sqrt(),
            above => bottom - (2.0 * (area - above) * lower / width).sqrt(),
        };
        let all = (last - first).max(1.0);
        let until = |square_px: f64| (height(above(first) + square_px) - first + 1.0).clamp(1.0, all) as f32;
        // Two samples are covered where two square pixels are, as a rule, and in almost all cases where six are.
        Self { all: all as f32, first: until(2.0), most_first: until(6.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_counted_until_a_triangle_covers_two_square_pixels() {
        // 20 rows high, 10 pixels wide where it is widest.
        let of = |heights, shown| TriangleRows::of(heights, 10.0, shown);
        let tip_above = of([0.0, 20.0, 20.0], [0.0, 20.0]);
        // Its first 2.8 rows hold two square pixels, and its first 4.9 six.
        assert_eq!([tip_above.all, tip_above.first.floor(), tip_above.most_first.floor()], [20.0, 3.0, 5.0]);
        let tip_below = of([0.0, 0.0, 20.0], [0.0, 20.0]);
        assert!(tip_below.first < 1.5, "its first row holds almost ten: {tip_below:?}");
        let later = of([0.0, 20.0, 20.0], [10.0, 20.0]);
        assert!(later.all == 10.0 && later.first < 1.5, "the picture begins where it is wide: {later:?}");
        let needle = TriangleRows::of([0.0, 20.0, 40.0], 0.05, [0.0, 40.0]);
        assert_eq!([needle.first, needle.most_first], [40.0, 40.0], "it covers one square pixel in all");
    }
}
