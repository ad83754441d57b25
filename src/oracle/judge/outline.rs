//! Outlines of triangles on the screen, and what may change at a sample when their vertices move.

use crate::{effects::hooks::ROUNDING, frame::SnappedVertex, scene::view::View};

/// A triangle on the screen, or the clipped triangles in its place.
pub struct Outline {
    pub triangles: Vec<[SnappedVertex; 3]>,
    /// Only the disc that touches the sides is drawn.
    pub is_disc: bool,
    /// How far an edge may have moved, in sub-pixel units; more than the distance of its ends in either axis.
    pub reach: f64,
}

impl Outline {
    /// Returns true if an edge or rim may have passed over a sample.
    pub fn may_pass(&self, at: &SamplePosition) -> bool {
        let is_near = |corners| at.border(corners) <= self.reach || self.is_disc && at.is_near_rim(corners, self.reach);
        self.reach == f64::INFINITY || self.reach > 0.0 && self.triangles.iter().any(is_near)
    }

    /// Smallest and largest depth that the surface may have at a sample; none more than a pixel away from it.
    pub fn depths(&self, at: &SamplePosition) -> Option<[f64; 2]> {
        let each = self.triangles.iter().filter_map(|corners| at.depths(corners, self.reach.clamp(2.0, at.unit)));
        each.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }
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
        Self { x: sample(pixel % width), y: sample(pixel / width), unit }
    }

    /// Distance to the segment between two corners.
    fn distance(&self, from: &SnappedVertex, to: &SnappedVertex) -> f64 {
        let (dx, dy) = (f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y));
        let (px, py) = (self.x - f64::from(from.x), self.y - f64::from(from.y));
        let length = dx * dx + dy * dy;
        let t = if length > 0.0 { ((px * dx + py * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
        libm::hypot(px - t * dx, py - t * dy)
    }

    /// Distance to the nearest edge of a triangle.
    fn border(&self, [a, b, c]: &[SnappedVertex; 3]) -> f64 {
        self.distance(a, b).min(self.distance(b, c)).min(self.distance(c, a))
    }

    /// Returns true if the rim of the ellipse that touches the sides at their midpoints may pass over this point when it moves by
    /// `reach` units. Its points are means of the corners, so they move no farther than the corners.
    fn is_near_rim(&self, [a, b, c]: &[SnappedVertex; 3], reach: f64) -> bool {
        let [a, b, c] = [a, b, c].map(|v| [f64::from(v.x), f64::from(v.y)]);
        let edge = |p: [f64; 2], q: [f64; 2], at: [f64; 2]| (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
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
            || around.into_iter().any(|(sin, cos)| is_inside([here[0] + reach * cos, here[1] + reach * sin]) != is_inside_here)
    }

    /// Interval of the depth of the plane through three corners, for movements of up to `reach` units and the error of a float key;
    /// none if the triangle is more than a pixel away.
    fn depths(&self, corners: &[SnappedVertex; 3], reach: f64) -> Option<[f64; 2]> {
        let [a, b, c] = corners.map(|v| [f64::from(v.x), f64::from(v.y), f64::from(v.depth)]);
        let edge = |p: [f64; 3], q: [f64; 3]| (q[0] - p[0]) * (self.y - p[1]) - (q[1] - p[1]) * (self.x - p[0]);
        let weights = [edge(b, c), edge(c, a), edge(a, b)];
        let area: f64 = weights.iter().sum();
        let covers = weights.iter().all(|weight| weight * area >= 0.0);
        if area == 0.0 || !covers && self.border(corners) > self.unit {
            return None;
        }
        let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
        let slope_x = (u[2] * v[1] - v[2] * u[1]) / area;
        let slope_y = (v[2] * u[0] - u[2] * v[0]) / area;
        let (low, high) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
        let depth = a[2] + slope_x * (self.x - a[0]) + slope_y * (self.y - a[1]);
        let error = reach * (slope_x.abs() + slope_y.abs()) + 64.0 * ROUNDING * depth.abs();
        Some([(depth - error).max(low).min(high), (depth + error).min(high).max(low)])
    }
}
