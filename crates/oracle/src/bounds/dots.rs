//! How far a float renderer may be from the dots along lines.

use rayon::prelude::*;

use super::{
    super::render::{
        dots::DotPlacement,
        snap::ClipPosition,
        vertex::{Corner, VertexEvaluator},
    },
    vertex::VertexBounds,
};
use crate::{
    effects::hooks::ROUNDING,
    scene::lines::{Segment, SegmentEnds},
};

/// A dot in clip space with the bounds of its coordinates' errors.
#[derive(Clone, Copy, Debug)]
pub struct BoundedDot {
    pub position: ClipPosition,
    pub errors: [f64; 4],
}

/// The dots of a picture with their bounds; none where an end of the dot's segment is refused.
pub fn bounded_dots(placement: &DotPlacement) -> Vec<Option<BoundedDot>> {
    let ends: Vec<_> = placement
        .lines
        .segments
        .par_iter()
        .map(|segment| bounded_ends(placement, segment))
        .collect();
    let positions = placement.positions();
    let bounded = |(i, position): (usize, &Option<ClipPosition>)| {
        let dot = placement.dots[i];
        let ends = ends[dot.segment as usize]?;
        Some(BoundedDot {
            position: (*position)?,
            errors: [0, 1, 2, 3].map(|r| error_between(&ends, r, dot.fraction)),
        })
    };
    positions.par_iter().enumerate().map(bounded).collect()
}

/// Coordinates of an end of a segment, and the bounds of their errors.
type BoundedEnd = [[f64; 4]; 2];

fn bounded_ends(placement: &DotPlacement, segment: &Segment) -> Option<[BoundedEnd; 2]> {
    match segment.ends {
        SegmentEnds::Edge {
            draw,
            vertices,
            triangle,
        } => {
            let evaluator = &placement.evaluators[draw as usize];
            let [a, b] =
                vertices.map(|vertex| bounded_corner(evaluator, Corner { vertex, triangle }));
            Some([a?, b?])
        }
        SegmentEnds::Points(points) => Some(points.map(|point| {
            let terms = placement.point_terms(point);
            let error =
                |row: [f64; 4]| 4.0 * ROUNDING * row.iter().map(|term| term.abs()).sum::<f64>();
            [terms.map(|row| row.iter().sum()), terms.map(error)]
        })),
    }
}

fn bounded_corner(evaluator: &VertexEvaluator, corner: Corner) -> Option<BoundedEnd> {
    let ClipPosition { x, y, z, w } = evaluator.clip(corner).ok()?;
    Some([
        [x, y, z, w],
        VertexBounds::new(evaluator, None).clip(corner).errors,
    ])
}

/// Errors of both ends, of the fraction and of mixing.
fn error_between([a, b]: &[BoundedEnd; 2], row: usize, fraction: f64) -> f64 {
    let [[at_a, error_a], [at_b, error_b]] =
        [a, b].map(|end| end.map(|coordinates| coordinates[row]));
    error_a + (error_b - error_a) * fraction + 8.0 * ROUNDING * (at_a.abs() + at_b.abs())
}
