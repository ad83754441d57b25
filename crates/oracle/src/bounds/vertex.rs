//! Forward error bounds of the vertex stage (`docs/exactness.md` §9): they hold for every rounding,
//! order and fusion of operations that WGSL allows. Rounding errors are proportional to the sums of
//! the terms' magnitudes, however much cancels; the errors of deformation and of vertex effects are
//! added.

use glam::DVec3;

use super::{
    super::{
        arithmetic::vector::DEGENERATE,
        render::{
            snap::ClipPosition,
            vertex::{Corner, Terms, VertexEvaluator},
        },
        shot::Shot,
    },
    deform::{self, Bounded},
    snap::{ClipErrors, on_grid, snap_bound},
};
use crate::{
    effects::hooks::{ErrorBound, ROUNDING},
    scene::{Bounds, draw::Draw},
};

/// For every record of [`project`](super::super::render::project::project), how far a float
/// renderer may place it before rounding, in sub-pixel units; none where rounding may move it
/// anywhere.
pub fn snap_bounds(shot: &Shot) -> Vec<Option<[f64; 2]>> {
    let of_draw = |draw: &Draw| {
        let evaluator = VertexEvaluator::new(shot.scene, draw, shot.view, shot.stack);
        let bounds = VertexBounds::new(&evaluator, None);
        let bound = |corner| {
            snap_bound(
                &evaluator.clip(corner).ok()?,
                bounds.clip(corner).errors,
                shot.view,
            )
        };
        evaluator
            .corners()
            .into_iter()
            .map(bound)
            .collect::<Vec<_>>()
    };
    shot.draws.iter().flat_map(of_draw).collect()
}

/// Second-order terms of a quotient, which are a fifteenth of the first-order ones at most.
const SECOND_ORDER: f64 = 16.0 / 15.0;

/// Bounds of the errors of what a [`VertexEvaluator`] evaluates.
pub struct VertexBounds<'a> {
    evaluator: &'a VertexEvaluator<'a>,
    /// Error of stored positions in object space.
    stored: DVec3,
}

impl<'a> VertexBounds<'a> {
    /// `packed_bits` are those of [`Geometry::packed_bits`](crate::frame::Geometry::packed_bits).
    pub fn new(evaluator: &'a VertexEvaluator<'a>, packed_bits: Option<u32>) -> Self {
        let primitive = &evaluator.scene.primitives[evaluator.draw.primitive];
        let stored = packed_bits.map_or(DVec3::ZERO, |bits| {
            packing_error(&primitive.drawable_box(evaluator.scene), bits)
        });
        Self { evaluator, stored }
    }

    /// Bounds of [`VertexEvaluator::clip`].
    pub fn clip(&self, corner: Corner) -> ClipErrors {
        let displacement = if self.evaluator.moves {
            self.moved(corner).offset_m
        } else {
            0.0
        };
        self.clip_displaced(corner, displacement)
    }

    /// The same in two parts, for x, y and w, given the bound of the moved corner: errors in any
    /// direction, and those along the one of [`ErrorBound::along_m`].
    pub fn clip_apart(&self, corner: Corner, moved: &ErrorBound) -> [DVec3; 2] {
        let along = |r: usize| {
            [0, 1, 2]
                .map(|axis| self.evaluator.clip_from_world[axis][r] * moved.along_m[axis])
                .iter()
                .sum::<f64>()
        };
        let displaced = self.clip_displaced(corner, moved.aside_m());
        [
            displaced.homogeneous(),
            DVec3::new(along(0), along(1), along(3)) * SECOND_ORDER,
        ]
    }

    /// Bounds of the clip position of a corner whose displacement errs by so many meters.
    fn clip_displaced(&self, corner: Corner, displacement: f64) -> ClipErrors {
        let bounds = self.clip_off_grid(corner, displacement);
        match self.evaluator.clip_off_grid(corner) {
            Ok((position, cell_px)) if cell_px > 0 => {
                on_grid(&position, cell_px, bounds, self.evaluator.view)
            }
            _ => bounds,
        }
    }

    /// The same before the place is rounded to the cells of an effect.
    fn clip_off_grid(&self, corner: Corner, displacement: f64) -> ClipErrors {
        let (evaluator, draw) = (self.evaluator, self.evaluator.draw);
        let position = self.position(corner.vertex);
        let mut magnitudes = evaluator.clip_rows(position.value - draw.origin(), Terms::Magnitudes);
        // Four products are added; subtracting an origin rounds once more.
        let roundings = if draw.origin == [0.0; 3] { 4.0 } else { 5.0 };
        let deformed = [0, 1, 2, 3].map(|r| self.clip_row_error(r, position.error) * (17.0 / 16.0));
        let offset = if evaluator.moves {
            self.displacement(corner)
        } else {
            DVec3::ZERO
        };
        if displacement == 0.0 && offset == DVec3::ZERO {
            return ClipErrors {
                errors: [0, 1, 2, 3].map(|r| roundings * ROUNDING * magnitudes[r] + deformed[r]),
                magnitudes,
            };
        }
        let errors = [0, 1, 2, 3].map(|r| {
            let row = [0, 1, 2].map(|axis| evaluator.clip_from_world[axis][r].abs());
            magnitudes[r] +=
                row[0] * offset.x.abs() + row[1] * offset.y.abs() + row[2] * offset.z.abs();
            // Three more products, added in any order.
            ((roundings + 3.0) * ROUNDING * magnitudes[r]
                + displacement * (row[0] + row[1] + row[2]))
                * SECOND_ORDER
                + deformed[r]
        });
        ClipErrors { errors, magnitudes }
    }

    /// Bounds of the errors of a corner in world space after all effects: of its displacement in
    /// meters, and of the direction of its normal.
    pub fn moved(&self, corner: Corner) -> ErrorBound {
        let (unmoved, given) = (self.evaluator.unmoved(corner), self.unmoved(corner));
        self.evaluator
            .stack
            .error_bound(unmoved, given, self.evaluator.draw.scopes)
    }

    /// A corner's displacement, meters.
    fn displacement(&self, corner: Corner) -> DVec3 {
        self.evaluator
            .stack
            .moved(self.evaluator.unmoved(corner), self.evaluator.draw.scopes)
            .offset
    }

    /// What an error of an object-space position adds to a row of its clip position.
    fn clip_row_error(&self, r: usize, error: DVec3) -> f64 {
        [0, 1, 2]
            .map(|axis| {
                f64::from(self.evaluator.draw.clip_from_object[axis][r]).abs() * error[axis]
            })
            .iter()
            .sum()
    }

    /// A deformed position in object space; the origin, without error, if it is refused.
    fn position(&self, vertex: u32) -> Bounded {
        let position =
            deform::position(self.evaluator.scene, self.evaluator.draw, vertex).unwrap_or_default();
        Bounded {
            error: position.error + self.stored,
            ..position
        }
    }

    /// Bounds of [`VertexEvaluator::unmoved`].
    fn unmoved(&self, corner: Corner) -> ErrorBound {
        let (evaluator, draw) = (self.evaluator, self.evaluator.draw);
        let m = draw.world_from_object;
        let magnitude = |p: DVec3| {
            let terms = m.x_axis.abs() * p.x.abs()
                + m.y_axis.abs() * p.y.abs()
                + m.z_axis.abs() * p.z.abs();
            terms.truncate()
        };
        let with_translation = |p: DVec3| (magnitude(p) + m.w_axis.abs().truncate()).max_element();
        let here = self.position(corner.vertex);
        let deformed = |error: DVec3| magnitude(error).max_element();
        // The matrix is rounded, then four products are added.
        let position_m = 5.0 * ROUNDING * with_translation(here.value) + deformed(here.error);
        let stored = deform::normal(evaluator.scene, draw, corner.vertex).unwrap_or_default();
        let normal = self.direction_error(stored.value, stored.error);
        if !evaluator.has_unshared_vertices {
            return ErrorBound {
                position_m,
                normal,
                center_m: position_m,
                ..ErrorBound::default()
            };
        }
        let corners = evaluator.triangle_positions(corner);
        let middle = corners.iter().map(|c| c.abs()).sum::<DVec3>() / 3.0;
        let edges = corners
            .iter()
            .map(|c| (here.value - c).abs())
            .sum::<DVec3>()
            / 3.0;
        let error = self.triangle_error(corner);
        let center_screen = self.screen_error(corners.iter().sum::<DVec3>() / 3.0, middle, error);
        ErrorBound {
            position_m,
            normal,
            center_m: 10.0 * ROUNDING * with_translation(middle) + deformed(error),
            arm_m: 12.0 * ROUNDING * magnitude(edges).max_element() + 2.0 * deformed(error),
            center_screen,
            flat_normal: self.plane_error(corners, error.max_element()),
            ..ErrorBound::default()
        }
    }

    /// Largest errors of the corners of a corner's triangle in object space.
    fn triangle_error(&self, corner: Corner) -> DVec3 {
        let primitive = &self.evaluator.scene.primitives[self.evaluator.draw.primitive];
        let errors = primitive
            .corners(self.evaluator.scene, corner.triangle)
            .map(|vertex| self.position(vertex).error);
        errors[0].max(errors[1]).max(errors[2])
    }

    /// Error of the direction of a normal in world space, given the bound of its error in object
    /// space; 2 where the direction itself is in doubt.
    fn direction_error(&self, normal: DVec3, given: DVec3) -> f64 {
        let n = self.evaluator.world_from_normal;
        let spread = |v: DVec3| n.x_axis.abs() * v.x + n.y_axis.abs() * v.y + n.z_axis.abs() * v.z;
        let error = spread(given) + 4.0 * ROUNDING * spread(normal.abs());
        if error == DVec3::ZERO {
            return 0.0;
        }
        let (length, error) = (
            (n * normal).length(),
            error.length() + 4.0 * f64::from(f32::MIN_POSITIVE),
        );
        if error < 0.5 * length {
            error / (length - error) + 10.0 * ROUNDING
        } else {
            2.0
        }
    }

    /// Error of the direction of a triangle's plane, given the bound of its corners' errors: large
    /// for needles, 2 where it is in doubt whether the triangle has a plane.
    fn plane_error(&self, [a, b, c]: [DVec3; 3], given: f64) -> f64 {
        let (ab, ac) = (b - a, c - a);
        let (long, wide) = (ab.abs().max_element(), ac.abs().max_element());
        if long == 0.0 || wide == 0.0 {
            return 0.0;
        }
        if long.min(wide) < 1e-36 {
            return 2.0;
        }
        let (u, v) = (ab / long, ac / wide);
        let term = |i: usize, j: usize| (u[i] * v[j]).abs() + (u[j] * v[i]).abs();
        // An edge has the errors of both its ends, before it is scaled.
        let edges = 5.0 * given * (1.0 / long + 1.0 / wide);
        let error = 9.0 * ROUNDING * DVec3::new(term(1, 2), term(2, 0), term(0, 1)) + edges;
        let (normal, length) = (u.cross(v), u.cross(v).length());
        let squared_error = 2.0 * length * error.length()
            + error.length_squared()
            + 8.0 * ROUNDING * length * length;
        match length * length - DEGENERATE {
            over if over.abs() <= squared_error => 2.0,
            over if over < 0.0 => 0.0,
            _ => self.direction_error(normal, error),
        }
    }

    /// Error of the projection of a triangle's center, as a fraction of the picture; infinite if
    /// the center may be behind the eye. `magnitudes` are those of the center's terms, `given`
    /// the bound of the corners' errors.
    fn screen_error(&self, center: DVec3, magnitudes: DVec3, given: DVec3) -> f64 {
        let (evaluator, draw) = (self.evaluator, self.evaluator.draw);
        let origin = draw.origin();
        let [x, y, _, w] = evaluator.clip_rows(center - origin, Terms::Signed);
        let sums = evaluator.clip_rows(magnitudes + origin.abs(), Terms::Magnitudes);
        // An error of the corners counts as a rounding of the sums.
        let mut sums =
            [0, 1, 2, 3].map(|r| sums[r] + self.clip_row_error(r, given) / (8.0 * ROUNDING));
        let mut point = ClipPosition { x, y, z: 0.0, w };
        // In the picture that a light's view is drawn for, the position in world space is rounded
        // first.
        let world = draw.world_from_object;
        let in_world = |v: DVec3| {
            (world.x_axis.abs() * v.x + world.y_axis.abs() * v.y + world.z_axis.abs() * v.z)
                .truncate()
        };
        let magnitude = in_world(magnitudes)
            + world.w_axis.abs().truncate()
            + in_world(given) / (8.0 * ROUNDING);
        if let Some([x, y, _, w]) =
            evaluator.picture_rows(world.transform_point3(center), Terms::Signed)
            && let Some(picture) = evaluator.picture_rows(magnitude, Terms::Magnitudes)
        {
            (point, sums) = (
                ClipPosition { x, y, z: 0.0, w },
                picture.map(|sum| 2.0 * sum),
            );
        }
        let (ClipPosition { x, y, w, .. }, [sum_x, sum_y, _, sum_w]) = (point, sums);
        let error_w = 10.0 * ROUNDING * sum_w;
        if w.abs() <= error_w {
            return f64::INFINITY;
        }
        let error = |c: f64, sum: f64| {
            (10.0 * ROUNDING * sum + (error_w + 6.0 * ROUNDING * w.abs()) * (c / w).abs())
                / (w.abs() - error_w)
        };
        if w < 0.0 {
            0.0
        } else {
            0.5 * error(x, sum_x).max(error(y, sum_y)) + 2.0 * ROUNDING
        }
    }
}

/// Bound of the error of a position that is stored as the nearest of evenly spaced steps in a box:
/// half a step, and the roundings of the step, the product and the sum.
fn packing_error(bounds: &Bounds, bits: u32) -> DVec3 {
    if bounds.is_empty() {
        return DVec3::ZERO;
    }
    let extent = bounds.max - bounds.min;
    0.5 * extent / f64::from((1u32 << bits) - 1) + 4.0 * ROUNDING * (bounds.min.abs() + extent)
}
