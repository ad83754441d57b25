//! The vertex hook: where is it?

use glam::{DVec2, DVec3};

use crate::params::Params;

/// A corner of a triangle before it is projected; a vertex effect moves it and passes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// World space before any vertex effect, metres.
    pub position: DVec3,
    /// How far the effects so far have moved it, metres: it stands at `position + offset`. Kept apart, so that a vertex
    /// that stays keeps its bits.
    pub offset: DVec3,
    /// Unit, world space, as the file says; zero where it has none.
    pub normal: DVec3,
    /// Unit normal of the triangle before any vertex effect; zero where it has no plane, or for an effect that does not
    /// ask for triangles.
    pub flat_normal: DVec3,
    /// Mean of the triangle's corners before any vertex effect; the position itself where nobody asks for triangles.
    pub center: DVec3,
    /// From the centre to the position, metres: a difference taken in the model, so that a place far from the origin costs
    /// it nothing.
    pub arm: DVec3,
    /// Where that mean stands in the picture, 0 to 1; the middle where it lies behind the eye. Zero where nobody asks for
    /// triangles.
    pub center_screen: DVec2,
    /// Global triangle id; 0 where nobody asks for triangles.
    pub triangle: u32,
}

/// How far the members of an f32 twin's [`Vertex`] may be from the reference, along any axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorBound {
    pub position_m: f64,
    pub offset_m: f64,
    pub normal: f64,
    pub flat_normal: f64,
    pub center_m: f64,
    pub arm_m: f64,
    pub center_screen: f64,
}

/// Largest relative error of one f32 addition or multiplication, whichever way it rounds.
pub const ROUNDING: f64 = 1.0 / (1 << 23) as f64;

/// A vertex effect's functions over its parameter words.
#[derive(Clone, Copy)]
pub struct VertexHook {
    /// It reads the triangle, so corners cannot be shared between triangles.
    pub needs_triangle: bool,
    pub moved: fn(Vertex, &[u32]) -> Vertex,
    pub error_bound: fn(&Vertex, ErrorBound, &[u32]) -> ErrorBound,
    pub max_displacement_m: fn(f64, &[u32]) -> f64,
}

/// The f64 side of an effect on the vertex hook.
pub trait VertexEffect: Params {
    /// It reads `flat_normal`, `center`, `arm`, `center_screen` or `triangle`.
    const NEEDS_TRIANGLE: bool;

    /// Changes `offset` and `normal` alone.
    fn moved(vertex: Vertex, params: &Self) -> Vertex;

    /// ErrorBound of what an f32 twin makes of `vertex`, whatever rounding, order and fusion WGSL allows, where `slack` is that
    /// of what it is given. Parameters that move nothing add nothing.
    fn error_bound(vertex: &Vertex, error_bound: ErrorBound, params: &Self) -> ErrorBound;

    /// How far it moves a vertex of a model of this radius at most.
    fn max_displacement_m(radius_m: f64, params: &Self) -> f64;
}
