//! Judges an adapter's clipped triangles: its own coverage is taken from them, so what they say of themselves must be right.

use super::super::arithmetic::edge::doubled_area;
use crate::{
    frame::{ClippedTriangle, Geometry, SnappedVertex},
    scene::view::View,
};

/// Number of clipped triangles that run against the others of their fan although they were not counted as dropped, and of those whose
/// outline is not that of the oracle's triangle in the same place. Where the oracle cuts a triangle in another way, nothing is said of
/// its outline.
pub fn wrong_clips(view: &View, adapter: &Geometry, own: &Geometry, counted_as_dropped: u32) -> u64 {
    let near = |a: &SnappedVertex, b: &SnappedVertex| a.x.abs_diff(b.x).max(a.y.abs_diff(b.y)) <= view.units_per_pixel().unsigned_abs();
    let is_same = |a: &ClippedTriangle, b: &ClippedTriangle| a.corners.iter().zip(&b.corners).all(|(a, b)| near(a, b));
    let (mut turned, mut wrong_outlines) = (0, 0);
    for fan in adapter.clipped_triangles.chunk_by(|a, b| a.parent == b.parent) {
        let facing = fan.iter().map(|a| doubled_area(&a.corners)).sum::<i64>().signum();
        turned += fan.iter().filter(|a| doubled_area(&a.corners).signum() != facing).count() as u64;
        let given = fan_of(&own.clipped_triangles, fan[0].parent);
        if given.len() == fan.len() && fan.iter().all(|a| given.iter().any(|b| is_same(a, b))) {
            let is_right = |a: &ClippedTriangle| given.iter().any(|b| is_same(a, b) && a.outline == b.outline);
            wrong_outlines += fan.iter().filter(|a| !is_right(a)).count() as u64;
        }
    }
    turned.saturating_sub(counted_as_dropped.into()) + wrong_outlines
}

/// The clipped triangles of a parent, among triangles that are sorted by parent.
fn fan_of(clipped: &[ClippedTriangle], parent: u32) -> &[ClippedTriangle] {
    &clipped[clipped.partition_point(|t| t.parent < parent)..clipped.partition_point(|t| t.parent <= parent)]
}
