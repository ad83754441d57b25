//! Inflate: every vertex moves along its own normal, so that a smooth surface swells or shrinks
//! without a tear.
//!
//! A surface at a constant distance from another has the same normals, so normals stay as they are.

use super::{
    BuiltIn, Effect,
    hooks::{ErrorBound, ROUNDING, Vertex, VertexEffect},
};
use crate::words;

words! {
    pub struct Inflate of "inflate" {
        amount_m: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Inflate>()
    .on_vertex::<Inflate>()
    .into()
});

impl VertexEffect for Inflate {
    const NEEDS_TRIANGLE: bool = false;

    fn moved(mut v: Vertex, p: &Self) -> Vertex {
        v.offset += v.normal * f64::from(p.amount_m);
        v
    }

    fn error_bound(v: &Vertex, mut error_bound: ErrorBound, p: &Self) -> ErrorBound {
        let amount = f64::from(p.amount_m).abs();
        if amount > 0.0 {
            error_bound.offset_m += amount * (error_bound.normal + 2.0 * ROUNDING)
                + ROUNDING * v.offset.abs().max_element();
        }
        error_bound
    }

    fn max_displacement_m(_: f64, p: &Self) -> f64 {
        f64::from(p.amount_m).abs()
    }
}
