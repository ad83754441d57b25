//! The vertex hook: where is it?

use std::sync::Arc;

use glam::{DVec2, DVec3};

/// A corner of a triangle before it is projected; a vertex effect moves it and passes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// World space before any vertex effect, meters.
    pub position: DVec3,
    /// How far the effects so far have moved it, meters: it lies at `position + offset`. The two
    /// are separate, so that a vertex that does not move keeps its bits.
    pub offset: DVec3,
    /// Unit, world space, as the file has it; zero where it has none.
    pub normal: DVec3,
    /// Unit normal of the triangle before any vertex effect; zero where it has no plane, or where
    /// no effect needs triangles.
    pub flat_normal: DVec3,
    /// Mean of the triangle's corners before any vertex effect; the position itself where no
    /// effect needs triangles.
    pub center: DVec3,
    /// From the center to the position, meters: a difference taken in the model, so that it is as
    /// exact far from the origin.
    pub arm: DVec3,
    /// Position of that mean in the picture, 0 to 1; the middle where it lies behind the eye. Zero
    /// where no effect needs triangles.
    pub center_screen: DVec2,
    /// Global triangle id; 0 where no effect needs triangles.
    pub triangle: u32,
    /// Side of the cells, pixels, to whose corners its place in the picture is rounded; 0: it keeps
    /// its place.
    pub cell_px: u32,
}

/// How far the members of the f32 side's [`Vertex`] may be from the f64 ones, along any axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorBound {
    pub position_m: f64,
    pub offset_m: f64,
    /// The part of `offset_m` whose direction is known: the offset errs by this vector or less of
    /// it to either side, and beside that by no more than the rest of `offset_m`. A model that
    /// is swayed far in one direction errs far in that one alone.
    pub along_m: DVec3,
    pub normal: f64,
    pub flat_normal: f64,
    pub center_m: f64,
    pub arm_m: f64,
    pub center_screen: f64,
}

impl ErrorBound {
    /// What is left of `offset_m` beside `along_m`.
    pub fn aside_m(&self) -> f64 {
        (self.offset_m - self.along_m.length()).max(0.0)
    }
}

/// Largest relative error of one f32 addition or multiplication, in any rounding mode.
pub const ROUNDING: f64 = 1.0 / (1 << 23) as f64;

/// Where a vertex effect moves vertices, given its parameter words; in place.
pub type VertexFunction = dyn Fn(&mut [Vertex], &[u32]) + Send + Sync;
/// The error bound of what it moves, given that of its input.
pub type VertexBoundFunction = dyn Fn(&Vertex, ErrorBound, &[u32]) -> ErrorBound + Send + Sync;
/// The farthest that it moves a vertex of a model of this radius, meters.
pub type DisplacementFunction = dyn Fn(f64, &[u32]) -> f64 + Send + Sync;

/// A vertex effect's functions over its parameter words.
#[derive(Clone)]
pub struct VertexHook {
    /// It reads the triangle, so triangles cannot share vertices.
    pub needs_triangle: bool,
    pub moved: Arc<VertexFunction>,
    pub error_bound: Arc<VertexBoundFunction>,
    pub max_displacement_m: Arc<DisplacementFunction>,
    /// What the text of a file does before it is held to its reach. None: nothing holds it.
    pub unheld: Option<Arc<VertexFunction>>,
}
