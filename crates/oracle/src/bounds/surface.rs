//! Bounds of the errors of what a float renderer interpolates from a triangle's corners: its normal
//! and, where it was clipped, its depth and its color.
//!
//! They follow from the bounds of the corners ([`VertexBounds`]) and of their weights. A quotient
//! of sums Σ bₖxₖ / Σ bₖ errs, to first order, by Σ δₖ (xₖ - x) / Σ bₖ, where bₖ errs by δₖ and x
//! is the quotient.

use glam::{DVec3, DVec4};

use super::{
    super::{
        perturbation::InterpolatedPerturbation,
        render::{
            surface::{Interpolation, SurfaceTriangle},
            vertex::VertexEvaluator,
        },
        shot::Shot,
    },
    vertex::VertexBounds,
};
use crate::effects::hooks::ROUNDING;

/// The error of a direction that may be any.
const ANY_DIRECTION: f64 = 2.0;

/// Bounds of the errors of a triangle's corners.
#[derive(Clone, Copy, Debug)]
pub struct CornerErrors {
    /// Of x, y and w in clip space, in any direction, and beside that along one.
    clip: [[DVec3; 2]; 3],
    /// Of displacements, meters.
    offsets_m: [f64; 3],
    /// Of the directions of normals.
    normals: [f64; 3],
}

/// Bounds of errors at a sample.
#[derive(Clone, Copy, Debug)]
pub struct SampleErrors {
    /// Of the direction of the interpolated normal.
    normal: f64,
    /// Of the direction of the plane.
    plane: f64,
    /// Of the depth, relative to it.
    depth: f64,
    /// Of the color that the corners' mix, linear RGBA.
    color: DVec4,
    /// Of the distances from the edges, pixels.
    edge_distance_px: DVec3,
}

/// How far the normal and the depth that are interpolated at a sample may err.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// Not so far that a color shows it.
    None,
    /// So little that colors change in proportion.
    Narrow,
    /// So far that first-order bounds say nothing of colors.
    Wide,
}

impl SampleErrors {
    pub fn doubt(&self) -> Doubt {
        // A sixteenth of a step of 255, in the dark, where gamma encoding is 13 times as steep.
        const VISIBLE: f64 = 1.0 / (1 << 16) as f64;
        // A color that has its maximum there falls by half of the square: half a step of 255.
        const LINEAR: f64 = 1.0 / 16.0;
        match self.normal.max(self.plane).max(self.depth) {
            error if error > LINEAR => Doubt::Wide,
            error if error > VISIBLE => Doubt::Narrow,
            _ => Doubt::None,
        }
    }

    /// Returns true if the color that the corners' mix may err by so much that the bound of a
    /// shaded color does not contain it. On an unclipped triangle it errs by 2^-19 of their
    /// differences at most.
    pub fn has_doubtful_color(&self) -> bool {
        self.color.max_element() > 1.0 / f64::from(1 << 18)
    }

    /// The normals turned, the depth stretched and the color moved by so many of these bounds: x, y
    /// and z of world space, and the depth; red, green, blue and alpha. Of corners that lie far
    /// before and far behind the eye a renderer may mix a depth of either sign.
    pub fn times(
        &self,
        [turn @ .., stretch]: [f64; 4],
        tint: [f64; 4],
    ) -> InterpolatedPerturbation {
        let turn = DVec3::from(turn);
        InterpolatedPerturbation {
            normal: turn * self.normal,
            plane: turn * self.plane,
            depth: stretch * self.depth,
            color: DVec4::from(tint) * self.color,
            edge_distance_px: DVec3::ZERO,
        }
    }

    /// The distances from the edges smaller and larger by their bounds, where that shows in a line
    /// that fades over one pixel.
    pub fn edge_distances(&self) -> Option<[InterpolatedPerturbation; 2]> {
        // Half a step of 255.
        const VISIBLE_PX: f64 = 1.0 / 512.0;
        let moved = |sign: f64| InterpolatedPerturbation {
            edge_distance_px: sign * self.edge_distance_px,
            ..InterpolatedPerturbation::default()
        };
        (self.edge_distance_px.max_element() > VISIBLE_PX).then(|| [moved(-1.0), moved(1.0)])
    }
}

impl CornerErrors {
    /// Of triangle `id`, one of the shot's; `packed_bits` are those of the geometry.
    pub fn of(shot: &Shot, id: u32, packed_bits: Option<u32>) -> Self {
        let draw = shot.draw_of(id).expect("a triangle of the shot");
        let evaluator = VertexEvaluator::new(shot.scene, draw, shot.view, shot.stack);
        let bounds = VertexBounds::new(&evaluator, packed_bits);
        let corners = evaluator.triangle_corners(id - draw.first_triangle);
        let moved = corners.map(|corner| bounds.moved(corner));
        let clip = [0, 1, 2].map(|k| bounds.clip_apart(corners[k], &moved[k]));
        Self {
            clip,
            offsets_m: moved.map(|bound| bound.offset_m),
            normals: moved.map(|bound| bound.normal),
        }
    }

    /// At the center of a pixel of the same triangle.
    ///
    /// However far the weights err, a renderer clamps them from 0 to 1 with a sum of 1, so what
    /// they mix lies between the corners'.
    pub fn at(&self, triangle: &SurfaceTriangle, x: usize, y: usize) -> SampleErrors {
        let Interpolation {
            weights,
            depths,
            normals,
            colors,
            displaced,
            tangents,
        } = triangle.interpolation(x, y);
        let errors = triangle.weight_errors(x, y, &self.clip);
        let mixed = |differences: [f64; 3]| {
            let sum: f64 = (0..3).map(|k| errors[k] * differences[k]).sum();
            sum.min(largest(differences))
        };
        let normal = normals.map_or(0.0, |normals| {
            let middle = (0..3).map(|k| normals[k] * weights[k]).sum::<DVec3>();
            let own = [0, 1, 2].map(|k| normals[k].length() * (self.normals[k] + 8.0 * ROUNDING));
            let of_corners = (0..3)
                .map(|k| (weights[k].abs() + errors[k]) * own[k])
                .sum::<f64>()
                .min(largest(own));
            relative(
                mixed(normals.map(|normal| (normal - middle).length())) + of_corners,
                middle.length(),
            )
        });
        let plane = displaced.map_or(0.0, |corners| self.plane(corners));
        // A texture's normal errs as the normal and the tangent do of which it is made, and as the
        // side does, which is made of both.
        let mapped = tangents.map_or([1.0, 0.0], |(tangents, [length, reach])| {
            let middle = (0..3)
                .map(|k| tangents.corners[k] * weights[k])
                .sum::<DVec3>();
            let own = tangents.lengths.map(|length| 16.0 * ROUNDING * length);
            let of_corners = (0..3).map(|k| (weights[k].abs() + errors[k]) * own[k]);
            let error = mixed(tangents.corners.map(|corner| (corner - middle).length()))
                + of_corners.sum::<f64>().min(largest(own));
            [2.0 + 3.0 * length / reach, 2.0 * error / reach]
        });
        let through_map = |error: f64| (mapped[0] * error + mapped[1]).min(ANY_DIRECTION);
        let color = (0..3).map(|k| colors[k] * weights[k]).sum::<DVec4>();
        SampleErrors {
            normal: through_map(normal),
            plane: through_map(plane),
            depth: mixed(depths.map(|depth| (depth - 1.0).abs())),
            color: [0, 1, 2, 3]
                .map(|channel| mixed(colors.map(|corner| (corner[channel] - color[channel]).abs())))
                .into(),
            edge_distance_px: triangle.edge_distance_errors_px(x, y, &self.clip),
        }
    }

    /// Returns true if a renderer may see the other side of the triangle at the center of a pixel.
    pub fn may_turn(&self, triangle: &SurfaceTriangle, x: usize, y: usize) -> bool {
        triangle.may_turn(x, y, &self.clip)
    }

    /// Of the direction of the plane through the displaced corners.
    fn plane(&self, [a, b, c]: [DVec3; 3]) -> f64 {
        let (ab, ac) = (b - a, c - a);
        let error = |k: usize, edge: DVec3| {
            self.offsets_m[0] + self.offsets_m[k] + 8.0 * ROUNDING * edge.length()
        };
        relative(
            ab.length() * error(2, ac) + ac.length() * error(1, ab),
            ab.cross(ac).length(),
        )
    }
}

fn largest(values: [f64; 3]) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// Bound of the error of the direction of a vector of this length.
fn relative(error: f64, length: f64) -> f64 {
    if error < 0.5 * length {
        error / (length - error)
    } else {
        ANY_DIRECTION
    }
}
