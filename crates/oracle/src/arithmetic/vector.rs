//! Vector geometry in f64: planes, normal matrices and the terms whose magnitudes bound rounding
//! errors.

use glam::{DMat3, DVec3};

/// A vector with components at most 1 and a squared length below this has no direction.
pub const DEGENERATE: f64 = 1e-12;

/// Normal of the plane through three points, outward if they run counterclockwise, of any length;
/// none for a needle or a point.
pub fn plane_normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let [u, v] = [b - a, c - a].map(|edge| edge / edge.abs().max_element());
    let normal = u.cross(v);
    // An edge of length 0 makes NaN, for which the comparison is false.
    (normal.length_squared() >= DEGENERATE).then_some(normal)
}

/// The matrix that transforms normals where `m` transforms points, up to a factor: the cofactors of
/// `m`, scaled to entries of at most 1. The factor is negative if `m` mirrors.
pub fn normal_matrix(m: DMat3) -> DMat3 {
    let cofactors = cofactors(&m);
    let largest = cofactors
        .to_cols_array()
        .into_iter()
        .fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    cofactors * if largest > 0.0 { 1.0 / largest } else { 0.0 }
}

/// Cofactors of a matrix: cross products of its columns.
pub fn cofactors(m: &DMat3) -> DMat3 {
    DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    )
}

/// Sums of the magnitudes of the terms of a cross product of vectors with these magnitudes.
pub fn cross_magnitudes(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(
        a.y * b.z + a.z * b.y,
        a.z * b.x + a.x * b.z,
        a.x * b.y + a.y * b.x,
    )
}

/// For each of three vectors, [`cross_magnitudes`] of the other two.
pub fn cross_terms(v: &[DVec3; 3]) -> [DVec3; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j): (usize, usize)| cross_magnitudes(v[i].abs(), v[j].abs()))
}

/// For every corner, how far the cross product of the next two corners may err where the corners
/// err by `errors`.
pub fn cross_errors(v: &[DVec3; 3], errors: &[DVec3; 3]) -> [DVec3; 3] {
    let largest = [0, 1, 2].map(|k| v[k].abs() + errors[k]);
    [(1, 2), (2, 0), (0, 1)].map(|(i, j): (usize, usize)| {
        cross_magnitudes(largest[i], errors[j]) + cross_magnitudes(errors[i], largest[j])
    })
}

/// The unit vector in the direction of `v`; zero if it has none.
pub fn direction(v: DVec3) -> DVec3 {
    v.try_normalize().unwrap_or(DVec3::ZERO)
}
