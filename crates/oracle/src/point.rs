//! Points and lines (`docs/exactness.md` §2). A point is drawn as a triangle about it, of which its disc
//! is shown, or where that is too small to hold a sample wherever it lies, the pixel in which the point
//! lies. A segment of a line is drawn as two triangles, whose sides lie half a pixel from it.

use crate::{
    frame::{SnappedVertex, vertex_flags},
    math::{GUARD_BAND, MAX_POINT_RADIUS_PX},
    scene::draw::Draw,
};

/// What of the triangle about a point is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The samples so near to the point, in sub-pixel units.
    Disc(i64),
    /// The sample of its pixel.
    Pixel,
}

impl Shown {
    /// Of a point of `draw` with this record, on a grid of so many bits.
    pub fn of(record: &SnappedVertex, draw: &Draw, subpixel_bits: u32) -> Self {
        let unit = f64::from(1u32 << subpixel_bits);
        let product = |a: f32, b: f32| match a.is_normal() && b.is_normal() {
            true => f64::from(a) * f64::from(b),
            false => 0.0,
        };
        // 24 bits times 24 bits fit an f64.
        let radius = product(draw.point_radius_px, record.inv_w).min(MAX_POINT_RADIUS_PX) * unit;
        let radius = radius.floor() as i64;
        match radius < least(subpixel_bits) {
            true => Self::Pixel,
            false => Self::Disc(radius),
        }
    }

    /// Is the sample at `x` and `y` shown of a point with this record?
    pub fn covers(self, point: [i64; 2], [x, y]: [i64; 2], unit: i64) -> bool {
        let [px, py] = point;
        match self {
            Self::Disc(radius) => (x - px).pow(2) + (y - py).pow(2) <= radius.pow(2),
            Self::Pixel => [(x, px), (y, py)]
                .into_iter()
                .all(|(at, p)| at.div_euclid(unit) == p.div_euclid(unit)),
        }
    }
}

/// Half the diagonal of a pixel in sub-pixel units, rounded up: a disc of this radius holds a sample.
fn least(subpixel_bits: u32) -> i64 {
    ((182 << subpixel_bits) + 255) >> 8
}

/// The corners of the triangle about a point with this record, counterclockwise on the screen unless
/// the draw mirrors.
pub fn corners(record: &SnappedVertex, draw: &Draw, subpixel_bits: u32) -> [SnappedVertex; 3] {
    let inner = match Shown::of(record, draw, subpixel_bits) {
        Shown::Disc(radius) => radius as i32 + 1,
        Shown::Pixel => least(subpixel_bits) as i32,
    };
    let half = inner * 1774 / 1024 + 1;
    let aside = if draw.mirrored { -half } else { half };
    let is_out = record.x.abs().max(record.y.abs()) > GUARD_BAND - 2 * inner;
    let flags = record.flags | if is_out { vertex_flags::GUARD[0] } else { 0 };
    [(-aside, inner), (aside, inner), (0, -2 * inner)].map(|(x, y)| SnappedVertex {
        x: record.x + x,
        y: record.y + y,
        flags,
        ..*record
    })
}

/// The corners of the first or the second triangle of a segment with these ends: of the four that lie
/// half a pixel before and behind each end, along the axis in which the segment is shorter.
pub fn line_corners(
    ends: [&SnappedVertex; 2],
    is_second: bool,
    subpixel_bits: u32,
) -> [SnappedVertex; 3] {
    let half = 1 << (subpixel_bits - 1);
    let [from, to] = ends;
    let (dx, dy) = ((to.x - from.x).abs(), (to.y - from.y).abs());
    let (x, y) = if dx >= dy { (0, half) } else { (half, 0) };
    let is_out = ends
        .iter()
        .any(|end| end.x.abs().max(end.y.abs()) > GUARD_BAND - half);
    let mut flags = from.flags | to.flags;
    if is_out || flags != 0 {
        flags |= vertex_flags::GUARD[0];
    }
    let corner = |end: &SnappedVertex, side: i32| SnappedVertex {
        x: end.x + side * x,
        y: end.y + side * y,
        flags,
        ..*end
    };
    match is_second {
        false => [corner(from, -1), corner(from, 1), corner(to, 1)],
        true => [corner(from, -1), corner(to, 1), corner(to, -1)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_shows_wherever_it_lies_and_only_inside_the_triangle_about_it() {
        for bits in [4, 8, 12] {
            let unit = 1i64 << bits;
            let smallest = Shown::Disc(least(bits));
            for k in 0..256 {
                let point = [k * unit / 256, (k * 37 % 256) * unit / 256];
                let samples = |shown: Shown| {
                    (-2..3)
                        .flat_map(|y| (-2..3).map(move |x| [x, y]))
                        .filter(|at| shown.covers(point, at.map(|k| k * unit + unit / 2), unit))
                        .count()
                };
                assert_eq!(samples(Shown::Pixel), 1, "{bits} bits, {point:?}");
                assert!(samples(smallest) >= 1, "{bits} bits, {point:?}");
            }
        }
        // Of a side of the triangle, the point is farther away than the disc is wide.
        for inner in [183i128, 500, 8193, 131_073] {
            let half = inner * 1774 / 1024 + 1;
            let doubled_area = 2 * half * inner;
            let squared_side = half * half + 9 * inner * inner;
            assert!(
                doubled_area.pow(2) >= inner.pow(2) * squared_side,
                "{inner}"
            );
        }
    }
}
