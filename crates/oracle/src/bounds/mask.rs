//! How far a float renderer may be from the mask coordinates of a clipped triangle.

use glam::{DVec2, DVec3};

use super::super::{
    arithmetic::vector::{cross_errors, cross_terms},
    render::mask::{ClippedCoords, MaskCoords},
};

/// Returns true if an adapter's records lie within the bounds, where the corners of the parent err
/// by `clip` in x, y and w of clip space.
pub fn allows(coords: &MaskCoords, clip: &[DVec3; 3], given: &[[u32; 4]]) -> bool {
    let [first, last] = given else { return false };
    let corners = [
        [first[0], first[1]],
        [first[2], first[3]],
        [last[0], last[1]],
    ];
    let is_near = |k: usize| {
        let bound = coords.clipped.as_ref().map_or(DVec2::ZERO, |clipped| {
            error(clipped, clip, k, coords.corners[k])
        });
        let distance =
            (DVec2::from(corners[k].map(|word| f64::from(word as i32))) - coords.corners[k]).abs();
        distance.cmple(bound).all()
    };
    last[2] != 0 && (0..3).all(is_near)
}

/// Bound of the error of corner `k`, which lies at `at`.
fn error(clipped: &ClippedCoords, clip: &[DVec3; 3], k: usize, at: DVec2) -> DVec2 {
    let (_, sum) = clipped.weights(clipped.points[k]);
    let parent = &clipped.parent;
    // A weight errs by a few roundings of the terms of its line, which are themselves sums of
    // rounded products, and with the corners.
    let (terms, given) = (
        cross_terms(&clipped.homogeneous),
        cross_errors(&clipped.homogeneous, clip),
    );
    let errors = [0, 1, 2].map(|i| {
        clipped.points[k]
            .abs()
            .dot(terms[i] / f64::from(1 << 18) + given[i])
    });
    let error = (0..3)
        .map(|k| (parent[k] - at).abs() * errors[k])
        .sum::<DVec2>();
    let certain = sum.abs() - errors.iter().sum::<f64>();
    let extent = (parent[1] - parent[0])
        .abs()
        .max((parent[2] - parent[0]).abs())
        / f64::from(1 << 20);
    if certain > 0.0 {
        error / certain + extent + 1.0
    } else {
        DVec2::INFINITY
    }
}
