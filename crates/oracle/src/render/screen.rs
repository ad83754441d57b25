//! A triangle on the screen: its corner weights, facing and depths, from snapped records or, if it
//! was clipped, from clip space.

use glam::{DVec2, DVec3};

use super::{
    super::arithmetic::{edge::doubled_area, vector::cross_terms},
    triangles::is_back,
    vertex::{Corner, VertexEvaluator},
    weights::Weights,
};
use crate::{
    frame::{SnappedVertex, vertex_flags},
    scene::{draw::Draw, view::View},
};

/// What follows from a triangle's position on the screen.
pub struct ScreenTriangle {
    pub weights: Weights,
    pub is_back: bool,
    /// Depths of the corners along the viewing direction, in meters.
    pub depths_m: [f64; 3],
    /// Projection of the mean of the corners, as a fraction of the picture; none if it is behind
    /// the eye.
    pub center: Option<DVec2>,
}

impl ScreenTriangle {
    /// A triangle of the evaluator's draw with these records.
    pub fn of(
        evaluator: &VertexEvaluator,
        view: &View,
        records: &[SnappedVertex; 3],
        corners: [Corner; 3],
    ) -> Self {
        let is_clipped = records
            .iter()
            .any(|record| record.flags & vertex_flags::CLIPPED != 0);
        if is_clipped {
            Self::clipped(evaluator, view, corners)
        } else {
            Self::snapped(records, evaluator.draw, view)
        }
    }

    fn snapped(records: &[SnappedVertex; 3], draw: &Draw, view: &View) -> Self {
        let (size, unit) = (
            DVec2::new(view.width.into(), view.height.into()),
            f64::from(view.units_per_pixel()),
        );
        let pixels = records.map(|r| DVec2::new(r.x.into(), r.y.into()) / unit);
        let screen = pixels.map(|at| at / size);
        let w = records.map(|r| 1.0 / f64::from(r.inv_w));
        let depth_m = |i: usize| linear_depth(view, f64::from(records[i].depth)).unwrap_or(w[i]);
        Self {
            weights: Weights::Snapped([0, 1, 2].map(|k| pixels[k].extend(records[k].inv_w.into()))),
            is_back: is_back(doubled_area(records), draw),
            depths_m: [0, 1, 2].map(depth_m),
            center: Some(
                (screen[0] * w[0] + screen[1] * w[1] + screen[2] * w[2]) / (w[0] + w[1] + w[2]),
            ),
        }
    }

    fn clipped(evaluator: &VertexEvaluator, view: &View, corners: [Corner; 3]) -> Self {
        let clip = corners.map(|corner| {
            evaluator
                .clip(corner)
                .expect("a triangle that is clipped has no rejected corner")
        });
        let v = clip.map(|p| DVec3::new(p.x, p.y, p.w));
        let sum = v[0] + v[1] + v[2];
        let rows = [v[1].cross(v[2]), v[2].cross(v[0]), v[0].cross(v[1])];
        // y points up in clip space: a negative determinant runs clockwise on the screen.
        let is_clockwise = v[0].dot(rows[0]) < 0.0;
        Self {
            weights: Weights::Homogeneous {
                rows: if is_clockwise {
                    rows.map(|row| -row)
                } else {
                    rows
                },
                terms: cross_terms(&v),
                corners: v,
            },
            is_back: is_clockwise != evaluator.draw.mirrored,
            depths_m: clip.map(|p| linear_depth(view, p.z / p.w).unwrap_or(p.w)),
            center: (sum.z > 0.0)
                .then(|| DVec2::new(0.5 + 0.5 * sum.x / sum.z, 0.5 - 0.5 * sum.y / sum.z)),
        }
    }
}

/// [`ScreenTriangle::center`] of a triangle; the middle of the picture if the center is behind the
/// eye.
pub fn center_screen(
    evaluator: &VertexEvaluator,
    view: &View,
    records: &[SnappedVertex; 3],
    corners: [Corner; 3],
) -> DVec2 {
    ScreenTriangle::of(evaluator, view, records, corners)
        .center
        .unwrap_or(DVec2::splat(0.5))
}

/// Depth in meters from an orthographic depth; none in perspective.
fn linear_depth(view: &View, depth: f64) -> Option<f64> {
    view.linear_depth_m.map(|_| view.depth_m(depth))
}
