//! Bounds of the errors of what a float renderer interpolates from a triangle's corners: its normal and, where it was clipped, its depth.
//!
//! Both follow from the bounds of the corners ([`VertexBounds`]) and of their weights. A quotient of sums Σ bₖxₖ / Σ bₖ errs, to first
//! order, by Σ δₖ (xₖ - x) / Σ bₖ, where bₖ errs by δₖ and x is the quotient.

use glam::DVec3;

use super::{
    super::{
        render::vertex::{Corner, VertexEvaluator},
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
    /// Of x, y and w in clip space.
    pub clip: [DVec3; 3],
    /// Of displacements, meters.
    offsets_m: [f64; 3],
    /// Of the directions of normals.
    normals: [f64; 3],
}

/// Bounds of errors at a sample.
#[derive(Clone, Copy, Debug)]
pub struct SampleErrors {
    /// Of the direction of the interpolated normal.
    pub normal: f64,
    /// Of the depth, relative to it.
    pub depth: f64,
}

impl CornerErrors {
    /// Of triangle `id`, one of the shot's; `packed_bits` are those of the geometry.
    pub fn of(shot: &Shot, id: u32, packed_bits: Option<u32>) -> Self {
        let draw = shot.draw_of(id).expect("a triangle of the shot");
        let evaluator = VertexEvaluator::new(shot.scene, draw, shot.view, shot.stack);
        let bounds = VertexBounds::new(&evaluator, packed_bits);
        let triangle = id - draw.first_triangle;
        let vertices = shot.scene.primitives[draw.primitive].corners(shot.scene, triangle);
        let corners = vertices.map(|vertex| Corner { vertex, triangle });
        let moved = corners.map(|corner| bounds.moved(corner));
        let clip = corners.map(|corner| {
            let [x, y, _, w] = bounds.clip(corner).errors;
            DVec3::new(x, y, w)
        });
        Self { clip, offsets_m: moved.map(|bound| bound.offset_m), normals: moved.map(|bound| bound.normal) }
    }

    /// At a sample with these weights, which err by `errors`. `depths` are those of the corners as parts of that of the sample; `normals`
    /// are in world space, of any length.
    ///
    /// However far the weights err, a renderer clamps them from 0 to 1 with a sum of 1, so what they mix lies between the corners'.
    pub fn at(&self, weights: [f64; 3], errors: [f64; 3], depths: [f64; 3], normals: Option<[DVec3; 3]>) -> SampleErrors {
        let mixed = |differences: [f64; 3]| {
            let sum: f64 = (0..3).map(|k| errors[k] * differences[k]).sum();
            sum.min(largest(differences))
        };
        let normal = normals.map_or(0.0, |normals| {
            let middle = (0..3).map(|k| normals[k] * weights[k]).sum::<DVec3>();
            let own = [0, 1, 2].map(|k| normals[k].length() * (self.normals[k] + 8.0 * ROUNDING));
            let of_corners = (0..3).map(|k| (weights[k].abs() + errors[k]) * own[k]).sum::<f64>().min(largest(own));
            relative(mixed(normals.map(|normal| (normal - middle).length())) + of_corners, middle.length())
        });
        SampleErrors { normal, depth: mixed(depths.map(|depth| (depth - 1.0).abs())) }
    }

    /// Of the direction of the plane through the displaced corners.
    pub fn plane(&self, [a, b, c]: [DVec3; 3]) -> f64 {
        let (ab, ac) = (b - a, c - a);
        let error = |k: usize, edge: DVec3| self.offsets_m[0] + self.offsets_m[k] + 8.0 * ROUNDING * edge.length();
        relative(ab.length() * error(2, ac) + ac.length() * error(1, ab), ab.cross(ac).length())
    }
}

fn largest(values: [f64; 3]) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

/// Bound of the error of the direction of a vector of this length.
fn relative(error: f64, length: f64) -> f64 {
    if error < 0.5 * length { error / (length - error) } else { ANY_DIRECTION }
}
