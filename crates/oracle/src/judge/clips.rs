//! Judges an adapter's clipped triangles: its own coverage is taken from them, so what they say of
//! themselves must be right.

use super::super::arithmetic::edge::doubled_area;
use crate::{
    frame::{ClippedTriangle, Geometry, SnappedVertex},
    scene::view::View,
};

/// Number of clipped triangles that run against the others of their fan although they were not
/// counted as dropped, and of those whose outline is not that of the oracle's triangle in the same
/// place. Outlines are not judged where the oracle cuts a triangle in another way (if triangles
/// were dropped, that cannot be told), or where corners lie so near each other that neighbors in a
/// fan may be mistaken.
pub fn wrong_clips(
    view: &View,
    adapter: &Geometry,
    own: &Geometry,
    counted_as_dropped: u32,
) -> u64 {
    let pixel = view.units_per_pixel().unsigned_abs();
    let distance = |a: &SnappedVertex, b: &SnappedVertex| a.x.abs_diff(b.x).max(a.y.abs_diff(b.y));
    let is_same = |a: &ClippedTriangle, b: &ClippedTriangle| {
        a.corners
            .iter()
            .zip(&b.corners)
            .all(|(a, b)| distance(a, b) <= pixel)
    };
    let is_spread = |a: &ClippedTriangle| {
        (0..3).all(|k| distance(&a.corners[k], &a.corners[(k + 1) % 3]) > 4 * pixel)
    };
    let (mut turned, mut wrong_outlines) = (0, 0);
    for fan in adapter
        .clipped_triangles
        .chunk_by(|a, b| a.parent == b.parent)
    {
        let facing = fan
            .iter()
            .map(|a| doubled_area(&a.corners))
            .sum::<i64>()
            .signum();
        turned += fan
            .iter()
            .filter(|a| doubled_area(&a.corners).signum() != facing)
            .count() as u64;
        let given = fan_of(&own.clipped_triangles, fan[0].parent);
        if counted_as_dropped == 0
            && given.len() == fan.len()
            && fan
                .iter()
                .all(|a| is_spread(a) && given.iter().any(|b| is_same(a, b)))
        {
            let is_right = |a: &ClippedTriangle| {
                given
                    .iter()
                    .any(|b| is_same(a, b) && a.outline == b.outline)
            };
            wrong_outlines += fan.iter().filter(|a| !is_right(a)).count() as u64;
        }
    }
    turned.saturating_sub(counted_as_dropped.into()) + wrong_outlines
}

/// The clipped triangles of a parent, among triangles that are sorted by parent.
fn fan_of(clipped: &[ClippedTriangle], parent: u32) -> &[ClippedTriangle] {
    &clipped[clipped.partition_point(|t| t.parent < parent)
        ..clipped.partition_point(|t| t.parent <= parent)]
}
