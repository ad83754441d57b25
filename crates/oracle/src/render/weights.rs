//! Weights of a triangle's corners at a sample: perspective-correct interpolation
//! (`docs/exactness.md` §3), from snapped corners, or in homogeneous space for triangles that were
//! clipped (Olano and Greer 1997).

use glam::{DVec2, DVec3};

use super::super::arithmetic::vector::{cross_errors, cross_magnitudes};
use crate::{
    effects::hooks::{ROUNDING, Shape},
    scene::view::View,
};

/// How the weights of a triangle's corners follow from the position of a sample.
pub enum Weights {
    /// Snapped corners: x and y in pixels, and 1/w. Weights are screen-space areas times 1/w.
    Snapped([DVec3; 3]),
    /// In clip space, valid even for w <= 0.
    Homogeneous {
        /// Cross products of the other two corners' (x, y, w), with the sign that makes them
        /// positive inside.
        rows: [DVec3; 3],
        /// Sums of the magnitudes of their terms.
        terms: [DVec3; 3],
        /// The corners' (x, y, w).
        corners: [DVec3; 3],
    },
}

/// The sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct SamplePoint {
    /// Pixels right and down from the top left.
    pub pixel: DVec2,
    /// The same as a fraction of the picture.
    pub screen: DVec2,
    /// What triangles cover.
    pub shape: Shape,
    /// If corners are drawn as discs, the corner whose disc contains the sample.
    pub corner: Option<usize>,
}

impl SamplePoint {
    /// In normalized device coordinates, with z = 1.
    fn ndc(&self) -> DVec3 {
        DVec3::new(2.0 * self.screen.x - 1.0, 1.0 - 2.0 * self.screen.y, 1.0)
    }
}

impl Weights {
    /// Perspective-correct weights at a sample, which sum to 1; equal weights if the triangle has
    /// no extent. In a box no weight is negative, and a disc belongs completely to its corner.
    pub fn at(&self, point: &SamplePoint) -> [f64; 3] {
        let terms = match self {
            Self::Snapped(corners) => {
                let areas = areas(corners, point);
                [0, 1, 2].map(|k| areas[k] * corners[k].z)
            }
            Self::Homogeneous { rows, .. } => {
                let p = point.ndc();
                // A snapped clipped triangle may cover a sample slightly outside, where the sum
                // vanishes near a horizon.
                rows.map(|row| p.dot(row).max(0.0))
            }
        };
        let sum: f64 = terms.iter().sum();
        let weights = terms.map(|term| term / sum);
        if weights.iter().all(|weight| weight.is_finite()) {
            weights
        } else {
            [1.0 / 3.0; 3]
        }
    }

    /// Bounds of the errors of `weights` in f32.
    pub fn errors(&self, weights: [f64; 3], point: &SamplePoint) -> [f64; 3] {
        // Fifteen roundings of numbers of the same sign.
        const SNAPPED: f64 = 15.0 / (1 << 23) as f64;
        match self {
            Self::Snapped(_) => weights.map(|weight| weight * SNAPPED),
            Self::Homogeneous { rows, terms, .. } => {
                let p = point.ndc();
                let sum: f64 = rows.iter().map(|row| p.dot(*row)).sum();
                // The terms have either sign: an error is proportional to their magnitudes, not to
                // their sum.
                terms.map(|terms| p.abs().dot(terms) / sum.abs() / f64::from(1 << 20))
            }
        }
    }

    /// As [`errors`](Self::errors), where the corners' (x, y, w) err by `clip`, in any direction
    /// and along one; large where nothing is known.
    pub fn errors_from(
        &self,
        clip: &[[DVec3; 2]; 3],
        weights: [f64; 3],
        point: &SamplePoint,
    ) -> [f64; 3] {
        const UNKNOWN: f64 = 1e30;
        let Self::Homogeneous { rows, corners, .. } = self else {
            return self.errors(weights, point);
        };
        let p = point.ndc();
        let sum = rows.iter().map(|row| p.dot(*row)).sum::<f64>().abs();
        let given = given_errors(p, corners, clip).map(|error| error / sum);
        let rounded = self.errors(weights, point);
        let errors = [0, 1, 2].map(|k| rounded[k] + given[k]);
        let whole = 1.0 - errors.iter().sum::<f64>();
        if whole > 0.0 {
            errors.map(|error| error / whole)
        } else {
            [UNKNOWN; 3]
        }
    }

    /// Bounds of the errors in f32 of the distances from the edges ([`on_screen`](Self::on_screen)) in a
    /// picture of this size, where the corners' (x, y, w) err by `clip`; large where nothing is known. Of snapped corners
    /// they are quotients of integers, whose errors do not show.
    pub fn edge_distance_errors_px(
        &self,
        clip: &[[DVec3; 2]; 3],
        point: &SamplePoint,
        [width, height]: [u32; 2],
    ) -> [f64; 3] {
        const UNKNOWN: f64 = 1e30;
        let Self::Homogeneous {
            rows,
            corners,
            terms,
        } = self
        else {
            return [0.0; 3];
        };
        let steps = DVec2::new(2.0 / f64::from(width), 2.0 / f64::from(height));
        let product_errors = |p: DVec3| {
            let given = given_errors(p, corners, clip);
            [0, 1, 2].map(|k| p.abs().dot(terms[k]) / f64::from(1 << 20) + given[k])
        };
        let p = point.ndc();
        let of_products = product_errors(p);
        let of_slopes = [DVec3::X * steps.x, DVec3::Y * steps.y].map(product_errors);
        [0, 1, 2].map(|k| {
            let slope = (rows[k].truncate() * steps).length();
            let slope_error = of_slopes[0][k] + of_slopes[1][k];
            let distance = p.dot(rows[k]).abs() / slope.max(1e-30);
            if slope > slope_error {
                ((of_products[k] + distance * slope_error) / (slope - slope_error)).min(UNKNOWN)
            } else {
                UNKNOWN
            }
        })
    }

    /// Returns true if f32 may take a triangle's back for its front at a sample, where the corners'
    /// (x, y, w) err by `clip`. Of a clipped triangle the determinant of the corners tells its side
    /// or, where that is within its roundings, the sample's place before the triangle's plane.
    pub fn may_turn(&self, clip: &[[DVec3; 2]; 3], point: &SamplePoint) -> bool {
        // Of a determinant of differences; the renderer trusts one that is more than that.
        const SIDE_ERROR: f64 = 8.0 * ROUNDING;
        let Self::Homogeneous { rows, corners, .. } = self else {
            return false;
        };
        let [ab, ac] = [corners[1] - corners[0], corners[2] - corners[0]];
        let [a, b, c] = clip.map(|[aside, along]| aside + along.abs());
        let rounded = |edge: DVec3, error: DVec3| error + ROUNDING * edge.abs();
        let (of_ab, of_ac) = (rounded(ab, a + b), rounded(ac, a + c));
        let terms = cross_magnitudes(ab.abs(), ac.abs());
        let plane_error = cross_magnitudes(ab.abs() + of_ab, of_ac)
            + cross_magnitudes(of_ab, ac.abs())
            + 3.0 * ROUNDING * terms;
        // As far as a product with the plane's normal may err; `terms` are larger than the normal.
        let error =
            |p: DVec3, p_error: DVec3| p.abs().dot(plane_error) + p_error.dot(terms + plane_error);
        let side = rows.iter().sum::<DVec3>();
        let determinant = corners[0].dot(side).abs();
        let trusted = 2.0 * SIDE_ERROR * corners[0].abs().dot(terms);
        if determinant > trusted + error(corners[0], a) {
            return false;
        }
        let p = point.ndc();
        p.dot(side) <= error(p, 8.0 * ROUNDING * p.abs())
    }

    /// Bound of the error in f32 of a sample's position relative to the eye, in meters. Weights of
    /// small triangles err by 9 steps of 2^-23, those of large ones by 15, and the point on the ray
    /// by a few more;
    /// on a clipped triangle the error is 2^-15 of the distance.
    pub fn position_error_m(&self, view: &View, position: DVec3) -> f64 {
        let from_eye = (position - view.eye).length();
        match self {
            Self::Snapped(_) => 24.0 * from_eye * ROUNDING,
            Self::Homogeneous { .. } => from_eye / f64::from(1 << 15),
        }
    }

    /// Differences of `weights` to the next pixel on the right and to the next one below: the
    /// derivative of a quotient whose numerator and denominator are linear on the screen.
    pub fn slopes(&self, weights: [f64; 3], point: &SamplePoint, view: &View) -> [[f64; 3]; 2] {
        let (terms, steps) = match self {
            Self::Snapped(corners) => {
                let at = |pixel: DVec2| {
                    let [a, b, c] = corners.map(|corner| corner.truncate() - pixel);
                    let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
                    DVec3::from([0, 1, 2].map(|k| areas[k] * corners[k].z))
                };
                let here = at(point.pixel);
                (
                    here,
                    [DVec2::X, DVec2::Y].map(|step| at(point.pixel + step) - here),
                )
            }
            Self::Homogeneous { rows, .. } => {
                let p = point.ndc();
                let terms = DVec3::from(rows.map(|row| p.dot(row)));
                let right = DVec3::from(rows.map(|row| row.x * 2.0 / f64::from(view.width)));
                (
                    terms,
                    [
                        right,
                        DVec3::from(rows.map(|row| row.y * -2.0 / f64::from(view.height))),
                    ],
                )
            }
        };
        let (weights, sum) = (DVec3::from(weights), terms.element_sum());
        steps.map(|step| ((step - weights * step.element_sum()) / sum).to_array())
    }

    /// Barycentric coordinates on the screen (of a clipped triangle: on its plane), and the
    /// distances of a sample from the edges opposite the corners, in pixels.
    pub fn on_screen(&self, point: &SamplePoint, view: &View) -> (DVec3, DVec3) {
        match self {
            Self::Snapped(corners) => {
                let [a, b, c] = corners.map(|corner| corner.truncate());
                let areas = areas(corners, point);
                let lengths = [(b, c), (c, a), (a, b)].map(|(from, to)| (to - from).length());
                let sum: f64 = areas.iter().sum();
                let edge_distance_px = [0, 1, 2].map(|k| areas[k] / lengths[k]);
                (
                    DVec3::from_array(areas) / sum,
                    DVec3::from_array(edge_distance_px),
                )
            }
            Self::Homogeneous { rows, .. } => {
                let p = point.ndc();
                let steps = DVec2::new(2.0 / f64::from(view.width), 2.0 / f64::from(view.height));
                let edge_distance_px =
                    rows.map(|row| p.dot(row).abs() / (row.truncate() * steps).length().max(1e-30));
                (
                    DVec3::from_array(self.at(point)),
                    DVec3::from_array(edge_distance_px),
                )
            }
        }
    }
}

/// How far the product of `p` with each row may err, where the corners err by `clip`.
fn given_errors(p: DVec3, corners: &[DVec3; 3], clip: &[[DVec3; 2]; 3]) -> [f64; 3] {
    let (aside, along) = (clip.map(|[aside, _]| aside), clip.map(|[_, along]| along));
    let moved = [0, 1, 2].map(|k| corners[k].abs() + along[k].abs());
    let aside = cross_errors(&moved, &aside);
    // Of a triangle that is long in the direction of the errors these products cancel, those of
    // magnitudes do not.
    let along = |i: usize, j: usize| {
        let products = [
            along[i].cross(corners[j]),
            corners[i].cross(along[j]),
            along[i].cross(along[j]),
        ];
        products
            .iter()
            .map(|product| p.dot(*product).abs())
            .sum::<f64>()
    };
    [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
        .map(|(k, i, j): (usize, usize, usize)| p.abs().dot(aside[k]) + along(i, j))
}

/// Doubled areas opposite the corners at a sample, positive inside for either winding.
fn areas(corners: &[DVec3; 3], point: &SamplePoint) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| corner.truncate() - point.pixel);
    let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    let winding = areas.iter().sum::<f64>().signum();
    match (point.shape, point.corner) {
        (Shape::Points, Some(corner)) => [0, 1, 2].map(|k| f64::from(u8::from(k == corner))),
        (Shape::Boxes, _) => areas.map(|area| (area * winding).max(0.0)),
        _ => areas.map(|area| area * winding),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// Numbers from -1 to 1 that look random.
    fn numbers() -> impl FnMut() -> f32 {
        let mut state = 1u32;
        move || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        }
    }

    #[test]
    fn distances_from_edges_in_f32_lie_within_their_bounds_however_far_corners_reach() {
        const SIZE: [u32; 2] = [640, 480];
        let mut number = numbers();
        let (mut judged, mut visible) = (0, 0);
        for turn in 0..20_000 {
            let reach = 10f32.powi(turn % 6);
            let corners = [0; 3].map(|_| reach * Vec3::new(number(), number(), number()));
            let [a, b, c] = corners.map(|corner| corner.as_dvec3());
            let magnitudes = [(b, c), (c, a), (a, b)];
            let weights = Weights::Homogeneous {
                rows: [b.cross(c), c.cross(a), a.cross(b)],
                terms: magnitudes.map(|(p, q)| cross_magnitudes(p.abs(), q.abs())),
                corners: [a, b, c],
            };
            let pixel = DVec2::new((turn % 640) as f64 + 0.5, (turn % 480) as f64 + 0.5);
            let screen = pixel / DVec2::new(640.0, 480.0);
            let (shape, corner) = (Shape::Triangles, None);
            let point = SamplePoint {
                pixel,
                screen,
                shape,
                corner,
            };
            let errors = weights.edge_distance_errors_px(&[[DVec3::ZERO; 2]; 3], &point, SIZE);
            let Weights::Homogeneous { rows, .. } = &weights else {
                unreachable!("as it was made");
            };
            let (p, steps) = (point.ndc(), DVec2::new(2.0 / 640.0, 2.0 / 480.0));
            let [a, b, c] = corners;
            let lines = [b.cross(c), c.cross(a), a.cross(b)];
            for k in 0..3 {
                let exact = p.dot(rows[k]).abs() / (rows[k].truncate() * steps).length();
                let slope = (lines[k].truncate() * steps.as_vec2()).length();
                let drawn = p.as_vec3().dot(lines[k]).abs() / slope.max(1e-30);
                let error = (f64::from(drawn) - exact).abs();
                assert!(error <= errors[k], "{turn}: {error} > {}", errors[k]);
                judged += u32::from(errors[k] < 1.0);
                visible += u32::from(error > 1.0 / 512.0);
            }
        }
        assert!(judged > 40_000, "{judged} bounds say something");
        assert!(visible > 0, "some errors show");
    }
}
