//! Psx: corners snap to a coarse grid of the picture, as on a console without fractions of a pixel.
//!
//! The place of a corner is rounded to 1/256 px, as always, and then in integers to a cell, so that
//! all adapters decide alike but where the first rounding differs on the edge of a cell. A shadow
//! map is drawn without a grid.

use super::{
    BuiltIn, Effect,
    hooks::{ErrorBound, Vertex, VertexEffect},
};
use crate::words;

words! {
    pub struct Psx of "psx" {
        cell_px: u32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Psx>()
    .on_vertex::<Psx>()
    .into()
});

impl VertexEffect for Psx {
    const NEEDS_TRIANGLE: bool = false;

    fn moved(mut v: Vertex, p: &Self) -> Vertex {
        v.cell_px = p.cell_px;
        v
    }

    fn error_bound(_: &Vertex, error_bound: ErrorBound, _: &Self) -> ErrorBound {
        error_bound
    }

    fn max_displacement_m(_: f64, _: &Self) -> f64 {
        0.0
    }
}
