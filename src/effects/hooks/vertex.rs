//! The vertex hook: where is it?

use glam::DVec3;

use crate::params::Params;

/// A corner of a triangle before it is projected; a vertex effect moves it and passes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// World space, metres.
    pub position: DVec3,
    /// Unit, world space, as the file says; zero where it has none.
    pub normal: DVec3,
    /// Unit normal of the triangle before any vertex effect; zero where it has no plane, or for an effect that does not
    /// ask for triangles.
    pub flat_normal: DVec3,
    /// Mean of the triangle's corners before any vertex effect; the position itself where nobody asks for triangles.
    pub center: DVec3,
    /// Global triangle id; 0 where nobody asks for triangles.
    pub triangle: u32,
}

/// A vertex effect's functions over its parameter words.
#[derive(Clone, Copy)]
pub struct VertexHook {
    /// It reads the triangle, so corners cannot be shared between triangles.
    pub needs_triangle: bool,
    pub moved: fn(Vertex, &[u32]) -> Vertex,
    /// Bound of the error of an f32 twin, metres, for this vertex as it comes in.
    pub slack_m: fn(&Vertex, &[u32]) -> f64,
}

/// The f64 side of an effect on the vertex hook.
pub trait VertexEffect: Params {
    /// It reads `flat_normal`, `center` or `triangle`.
    const NEEDS_TRIANGLE: bool;

    fn moved(vertex: Vertex, params: &Self) -> Vertex;

    /// Bound of the error of an f32 twin along any axis, metres, whatever rounding, order and fusion WGSL allows; the
    /// error of the position that comes in is not part of it.
    fn slack_m(vertex: &Vertex, params: &Self) -> f64;
}
