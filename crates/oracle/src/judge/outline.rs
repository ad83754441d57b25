//! Outlines of triangles on the screen, and what may change at a sample when their vertices move.

use super::super::{arithmetic::edge::doubled_area, point::Shown};
use crate::{effects::hooks::ROUNDING, frame::SnappedVertex, scene::view::View};

/// What of a triangle is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    Inside,
    /// The disc that touches the sides.
    Disc,
    /// The bounding box, at the depth of the nearest corner.
    Box,
    /// Discs of this radius about the corners, in sub-pixel units, each at the depth of its corner.
    Points(i64),
    /// A point, which is all three corners.
    Point(Shown),
}

/// A triangle on the screen, or the clipped triangles in its place.
pub struct Outline {
    pub triangles: Vec<[SnappedVertex; 3]>,
    pub drawn: Drawn,
    /// How far an edge may have moved, in sub-pixel units; more than the distance of its ends in
    /// either axis.
    pub reach: f64,
    /// Of a clipped triangle: bound of the error of its points in clip space. At a point it moves
    /// an edge by this over w, in halves of the picture. A depth there follows from the corners',
    /// of which each errs by this over its own w.
    pub clip_error: f64,
    /// How far the depth of a corner is from the adapter's.
    pub depth_error: f64,
    /// Half the larger side of the picture, in sub-pixel units.
    pub half_picture: f64,
}

impl Outline {
    /// Returns true if the triangle may lie anywhere else at all.
    pub fn may_move(&self) -> bool {
        self.reach > 0.0
    }

    /// How far an edge may have moved near a sample, and the relative error of a depth there.
    fn errors(&self, corners: &[SnappedVertex; 3], at: &SamplePosition) -> [f64; 2] {
        if self.clip_error == 0.0 {
            return [self.reach, 0.0];
        }
        let [inv_w, of_corners] = at.inv_w(corners);
        [
            self.reach.max(self.clip_error * inv_w * self.half_picture),
            self.clip_error * of_corners,
        ]
    }

    /// Returns true if an edge or rim may have passed over a sample.
    pub fn may_pass(&self, at: &SamplePosition) -> bool {
        let passes = |corners: &[SnappedVertex; 3]| {
            let [reach, _] = self.errors(corners, at);
            match self.drawn {
                Drawn::Inside => at.border(corners) <= reach,
                Drawn::Disc => at.border(corners) <= reach || at.is_near_rim(corners, reach),
                Drawn::Box => {
                    at.box_distance(corners).abs() <= reach
                        || at.box_distance(corners) < 0.0 && may_vanish(corners, reach)
                }
                Drawn::Point(shown) => (at.distance_from(&corners[0], shown)).abs() <= reach,
                Drawn::Points(radius) => corners.iter().any(|corner| {
                    let outside = at.distance(corner, corner) - radius as f64;
                    outside.abs() <= reach || outside < 0.0 && may_vanish(corners, reach)
                }),
            }
        };
        self.reach == f64::INFINITY || self.may_move() && self.triangles.iter().any(passes)
    }

    /// Smallest and largest depth that the surface may have at a sample; none more than a pixel
    /// away from it.
    pub fn depths(&self, at: &SamplePosition) -> Option<[f64; 2]> {
        let each = self
            .triangles
            .iter()
            .filter_map(|corners| match self.drawn {
                Drawn::Inside | Drawn::Disc => at.depths(corners, self.errors(corners, at)),
                Drawn::Box if at.box_distance(corners) > at.unit => None,
                Drawn::Box => Some(around(
                    corners
                        .iter()
                        .fold(0.0, |nearest, corner| corner.depth.max(nearest)),
                )),
                Drawn::Point(shown) => (at.distance_from(&corners[0], shown) <= at.unit)
                    .then(|| around(corners[0].depth)),
                Drawn::Points(radius) => {
                    let under = corners
                        .iter()
                        .filter(|corner| at.distance(corner, corner) <= radius as f64 + at.unit);
                    under.map(|corner| around(corner.depth)).reduce(union)
                }
            });
        each.reduce(union)
            .map(|[low, high]| [low - self.depth_error, high + self.depth_error])
    }
}

/// Returns true if the corners may fall on one line, or change their order around it, when they
/// move by `reach`: then nothing is drawn, or the other side.
fn may_vanish([a, b, c]: &[SnappedVertex; 3], reach: f64) -> bool {
    let area = doubled_area(&[*a, *b, *c]).unsigned_abs() as f64;
    let side = |p: &SnappedVertex, q: &SnappedVertex| {
        libm::hypot(
            f64::from(q.x) - f64::from(p.x),
            f64::from(q.y) - f64::from(p.y),
        )
    };
    area <= reach * (side(a, b) + side(b, c) + side(c, a)) + 4.0 * reach * reach
}

/// The depth of a corner with the error of a float.
fn around(depth: f32) -> [f64; 2] {
    let error = 64.0 * ROUNDING * f64::from(depth).abs();
    [f64::from(depth) - error, f64::from(depth) + error]
}

fn union(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// The sample of a pixel, in sub-pixel units.
pub struct SamplePosition {
    x: f64,
    y: f64,
    /// Units in a pixel.
    unit: f64,
}

impl SamplePosition {
    pub fn of(view: &View, pixel: usize) -> Self {
        let width = view.width as usize;
        let unit = f64::from(view.units_per_pixel());
        let sample = |k: usize| (k as f64 + 0.5) * unit;
        Self {
            x: sample(pixel % width),
            y: sample(pixel / width),
            unit,
        }
    }

    /// Distance to the segment between two corners.
    fn distance(&self, from: &SnappedVertex, to: &SnappedVertex) -> f64 {
        let (dx, dy) = (
            f64::from(to.x) - f64::from(from.x),
            f64::from(to.y) - f64::from(from.y),
        );
        let (px, py) = (self.x - f64::from(from.x), self.y - f64::from(from.y));
        let length = dx * dx + dy * dy;
        let t = if length > 0.0 {
            ((px * dx + py * dy) / length).clamp(0.0, 1.0)
        } else {
            0.0
        };
        libm::hypot(px - t * dx, py - t * dy)
    }

    /// Distance from what is shown of a point, negative inside.
    fn distance_from(&self, point: &SnappedVertex, shown: Shown) -> f64 {
        let (dx, dy) = (self.x - f64::from(point.x), self.y - f64::from(point.y));
        match shown {
            Shown::Disc(radius) => libm::hypot(dx, dy) - radius as f64,
            Shown::Pixel => dx.abs().max(dy.abs()) - self.unit / 2.0,
        }
    }

    /// Distance to the bounding box of a triangle's corners, negative inside.
    fn box_distance(&self, corners: &[SnappedVertex; 3]) -> f64 {
        let outside = |here: f64, at: [i32; 3]| {
            let [low, high] =
                [at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2])].map(f64::from);
            (low - here).max(here - high)
        };
        let [dx, dy] = [
            outside(self.x, corners.map(|c| c.x)),
            outside(self.y, corners.map(|c| c.y)),
        ];
        if dx > 0.0 && dy > 0.0 {
            libm::hypot(dx, dy)
        } else {
            dx.max(dy)
        }
    }

    /// Distance to the nearest edge of a triangle.
    fn border(&self, [a, b, c]: &[SnappedVertex; 3]) -> f64 {
        self.distance(a, b)
            .min(self.distance(b, c))
            .min(self.distance(c, a))
    }

    /// Returns true if the rim of the ellipse that touches the sides at their midpoints may pass
    /// over this point when it moves by `reach` units. Its points are means of the corners, so
    /// they move no farther than the corners.
    fn is_near_rim(&self, [a, b, c]: &[SnappedVertex; 3], reach: f64) -> bool {
        let [a, b, c] = [a, b, c].map(|v| [f64::from(v.x), f64::from(v.y)]);
        let edge = |p: [f64; 2], q: [f64; 2], at: [f64; 2]| {
            (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0])
        };
        let area = edge(a, b, c);
        let is_inside = |at: [f64; 2]| {
            let parts = [edge(b, c, at), edge(c, a, at), edge(a, b, at)];
            2.0 * parts.iter().map(|part| part * part).sum::<f64>() <= area * area
        };
        let here = [self.x, self.y];
        let middle = [0, 1].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        let around = (0..16).map(|k| libm::sincos(f64::from(k) * std::f64::consts::TAU / 16.0));
        let is_inside_here = is_inside(here);
        libm::hypot(here[0] - middle[0], here[1] - middle[1]) <= reach
            || around.into_iter().any(|(sin, cos)| {
                is_inside([here[0] + reach * cos, here[1] + reach * sin]) != is_inside_here
            })
    }

    /// 1/w of the triangle at this point, or at one of its points nearby, and the mean of the
    /// corners' own, by their perspective weights.
    fn inv_w(&self, corners: &[SnappedVertex; 3]) -> [f64; 2] {
        let [a, b, c] = corners.map(|v| [f64::from(v.x), f64::from(v.y)]);
        let edge = |p: [f64; 2], q: [f64; 2]| {
            (q[0] - p[0]) * (self.y - p[1]) - (q[1] - p[1]) * (self.x - p[0])
        };
        let weights = [edge(b, c), edge(c, a), edge(a, b)];
        let side = weights.iter().sum::<f64>().signum();
        let inside = weights.map(|weight| (weight * side).max(0.0));
        let inv_w = corners.map(|corner| f64::from(corner.inv_w));
        let [sum, first, second] = [0, 1, 2].map(|power| {
            (0..3)
                .map(|k| inside[k] * inv_w[k].powi(power))
                .sum::<f64>()
        });
        if first == 0.0 {
            return [inv_w[0].max(inv_w[1]).max(inv_w[2]); 2];
        }
        [first / sum, second / first]
    }

    /// Interval of the depth of the plane through three corners, where an edge may have moved by
    /// `reach` units and depths have a relative error, and that of a float key; none if the
    /// triangle is more than a pixel away.
    fn depths(
        &self,
        corners: &[SnappedVertex; 3],
        [reach, relative]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let reach = reach.max(2.0);
        let [a, b, c] = corners.map(|v| [f64::from(v.x), f64::from(v.y), f64::from(v.depth)]);
        let edge = |p: [f64; 3], q: [f64; 3]| {
            (q[0] - p[0]) * (self.y - p[1]) - (q[1] - p[1]) * (self.x - p[0])
        };
        let weights = [edge(b, c), edge(c, a), edge(a, b)];
        let area: f64 = weights.iter().sum();
        let covers = weights.iter().all(|weight| weight * area >= 0.0);
        if area == 0.0 || !covers && self.border(corners) > reach.max(self.unit) {
            return None;
        }
        let (u, v) = (
            [b[0] - a[0], b[1] - a[1], b[2] - a[2]],
            [c[0] - a[0], c[1] - a[1], c[2] - a[2]],
        );
        let slope_x = (u[2] * v[1] - v[2] * u[1]) / area;
        let slope_y = (v[2] * u[0] - u[2] * v[0]) / area;
        let (low, high) = (
            a[2].min(b[2]).min(c[2]) * (1.0 - relative),
            a[2].max(b[2]).max(c[2]) * (1.0 + relative),
        );
        let depth = a[2] + slope_x * (self.x - a[0]) + slope_y * (self.y - a[1]);
        let error =
            reach * (slope_x.abs() + slope_y.abs()) + (relative + 64.0 * ROUNDING) * depth.abs();
        Some([
            (depth - error).max(low).min(high),
            (depth + error).min(high).max(low),
        ])
    }
}
