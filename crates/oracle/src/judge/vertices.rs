//! Judges vertex records, each from the matrix bits.

use super::super::{
    bounds::{
        snap::{attributes_fit, snap_bound, whole_units},
        vertex::VertexBounds,
    },
    render::{
        records::fill_records,
        vertex::{Corner, VertexEvaluator},
    },
    shot::Shot,
};
use crate::{
    frame::{Geometry, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    measure::ErrorReport,
    work::Canceled,
};

/// What was found about one record.
#[derive(Clone, Copy, Debug, Default)]
pub struct VertexError {
    /// Rounding may have moved it anywhere, or to the other side of a plane: counted, not judged.
    pub is_ill_conditioned: bool,
    /// The larger of the distances in x and y, in sub-pixel units.
    pub delta: u32,
    pub snap_is_outside: bool,
    pub attribute_is_outside: bool,
    /// Bound of the error of x or y plus that of w, in clip space: how far the error of this
    /// corner may move the outline of a clipped triangle at w = 1, in halves of the picture.
    pub clip_error: f64,
}

/// Compares an adapter's records with the oracle's.
pub fn vertex_errors(
    shot: &Shot,
    adapter: &Geometry,
    own: &Geometry,
) -> Result<Vec<VertexError>, Canceled> {
    let pairs = adapter.vertices.iter().zip(&own.vertices);
    if adapter.bit_exact.vertices {
        return Ok(pairs
            .map(|(adapter, own)| strict_error(adapter, own))
            .collect());
    }
    bounded_errors(shot, adapter, own)
}

/// Compares an adapter's records with the bounds of float vertices.
pub fn bounded_errors(
    shot: &Shot,
    adapter: &Geometry,
    own: &Geometry,
) -> Result<Vec<VertexError>, Canceled> {
    fill_records(shot, |evaluator, first, errors| {
        let bounds = VertexBounds::new(evaluator, adapter.packed_bits);
        for (error, at) in errors.iter_mut().zip(first..) {
            let corner = evaluator.corner(at);
            let records = (&adapter.vertices[at], &own.vertices[at]);
            *error = bounded_error(evaluator, &bounds, shot, corner, records.0, records.1);
        }
    })
}

/// Adds what was found to a report.
pub fn count_vertices(report: &mut ErrorReport, errors: &[VertexError]) {
    for error in errors {
        report.vertices += 1;
        report.ill_conditioned += u64::from(error.is_ill_conditioned);
        report.snap_outside_bound += u64::from(error.snap_is_outside);
        report.attribute_outside_bound += u64::from(error.attribute_is_outside);
        report.snap_over_one_unit += u64::from(error.delta > 1);
        report.max_snap_delta = report.max_snap_delta.max(error.delta);
    }
}

/// A record of strict vertices must be equal, bit by bit.
fn strict_error(adapter: &SnappedVertex, own: &SnappedVertex) -> VertexError {
    let bits = |v: &SnappedVertex| [v.depth.to_bits(), v.inv_w.to_bits()];
    let delta = if own.flags == 0 {
        distance(adapter, own)
    } else {
        0
    };
    let snap_is_outside = adapter.flags != own.flags || delta > 0;
    VertexError {
        delta,
        snap_is_outside,
        attribute_is_outside: bits(adapter) != bits(own),
        ..Default::default()
    }
}

/// The larger of the distances in x and y.
fn distance(a: &SnappedVertex, b: &SnappedVertex) -> u32 {
    a.x.abs_diff(b.x).max(a.y.abs_diff(b.y))
}

/// Compares one record with its forward error bound.
fn bounded_error(
    evaluator: &VertexEvaluator,
    bounds: &VertexBounds,
    shot: &Shot,
    corner: Corner,
    adapter: &SnappedVertex,
    own: &SnappedVertex,
) -> VertexError {
    let Ok(position) = evaluator.clip(corner) else {
        return rejected_error(adapter, own);
    };
    let errors = bounds.clip(corner);
    let [ex, ey, ez, ew] = errors.errors;
    let clip_error = ex.max(ey) + ew;
    let ill_conditioned = VertexError {
        is_ill_conditioned: true,
        clip_error,
        ..Default::default()
    };
    let Some(snap_bounds) =
        snap_bound(&position, errors.errors, shot.view).map(|bounds| bounds.map(whole_units))
    else {
        return ill_conditioned;
    };
    if adapter.flags != own.flags {
        let may_cross_near = (position.w - position.z).abs() <= ez + ew;
        let is_explained = may_cross_near || guard_explains(adapter, own, snap_bounds);
        return if is_explained {
            ill_conditioned
        } else {
            VertexError {
                snap_is_outside: true,
                clip_error,
                ..Default::default()
            }
        };
    }
    if own.flags == 0 {
        let [dx, dy] = [adapter.x.abs_diff(own.x), adapter.y.abs_diff(own.y)];
        let snap_is_outside = f64::from(dx) > snap_bounds[0] || f64::from(dy) > snap_bounds[1];
        let attribute_is_outside = !attributes_fit(adapter, &position, &errors);
        return VertexError {
            delta: dx.max(dy),
            snap_is_outside,
            attribute_is_outside,
            clip_error,
            ..Default::default()
        };
    }
    let is_near = own.flags & vertex_flags::NEAR != 0;
    VertexError {
        attribute_is_outside: !is_near && !attributes_fit(adapter, &position, &errors),
        clip_error,
        ..Default::default()
    }
}

/// A vertex that the oracle rejects must be rejected, for the same reason.
fn rejected_error(adapter: &SnappedVertex, own: &SnappedVertex) -> VertexError {
    let is_nonfinite = |v: &SnappedVertex| v.flags & vertex_flags::NONFINITE != 0;
    let is_right =
        adapter.flags & vertex_flags::REJECTED != 0 && is_nonfinite(adapter) == is_nonfinite(own);
    VertexError {
        snap_is_outside: !is_right,
        ..Default::default()
    }
}

/// Returns true if two records have different flags only because they lie near a side of the guard
/// band.
fn guard_explains(
    adapter: &SnappedVertex,
    own: &SnappedVertex,
    [bound_x, bound_y]: [f64; 2],
) -> bool {
    let is_near_guard =
        |at: i32, bound: f64| f64::from(at.abs().abs_diff(GUARD_BAND)) <= bound + 1.0;
    let differs = adapter.flags ^ own.flags;
    let [left, right, top, bottom] = vertex_flags::GUARD;
    let x_explains = differs & (left | right) == 0 || is_near_guard(own.x, bound_x);
    let y_explains = differs & (top | bottom) == 0 || is_near_guard(own.y, bound_y);
    differs & (vertex_flags::REJECTED | vertex_flags::NEAR) == 0 && x_explains && y_explains
}
