//! Points: draws the corners of triangles as discs instead of the triangles.
//!
//! Integers decide: a sample belongs to a disc when its squared distance from the snapped corner is
//! at most the squared radius. Corners of triangles that would have to be clipped are not drawn.

use super::{BuiltIn, Effect, hooks::Slot};
use crate::words;

words! {
    pub struct Points of "points" {
        size_px: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Points>()
    .in_slot(Slot::Coverage)
    .into()
});

impl Points {
    /// Radius in units of 1/256 px.
    pub fn radius(&self) -> u32 {
        (f64::from(self.size_px) * 128.0).round_ties_even() as u32
    }
}
