//! Edge functions of snapped triangles in i64, and the top-left fill rule (`docs/exactness.md` §3).

use crate::frame::SnappedVertex;

/// Twice the area of the triangle (a, b, point), in square units: positive on the inner side of an
/// edge of a clockwise triangle (y runs downwards).
#[inline]
pub fn edge(a: &SnappedVertex, b: &SnappedVertex, x: i64, y: i64) -> i64 {
    let [ax, ay, bx, by] = [a.x, a.y, b.x, b.y].map(i64::from);
    (bx - ax) * (y - ay) - (by - ay) * (x - ax)
}

/// Twice the area of a snapped triangle, in square units; positive if it runs clockwise on the
/// screen.
pub fn doubled_area([a, b, c]: &[SnappedVertex; 3]) -> i64 {
    edge(a, b, i64::from(c.x), i64::from(c.y))
}

/// Returns true if a sample belongs to the inner side of a directed edge (dx, dy), where `e` is
/// `edge` at the sample.
///
/// A sample on the edge belongs to the side onto which it falls when it is moved by an
/// infinitesimal step to the right and a far smaller one down: this is the top-left rule without a
/// bias. The steps are 2^-30 and 2^-60, which no integer distance can outweigh: |e| < 2^63, |dx|
/// and |dy| < 2^29.
#[inline]
pub fn owns(e: i64, dx: i32, dy: i32) -> bool {
    (i128::from(e) << 60) - (i128::from(dy) << 30) + i128::from(dx) > 0
}
