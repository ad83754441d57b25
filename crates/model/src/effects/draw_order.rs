//! Draw order: stops the picture after a number of samples, so that one sees the order in which it
//! is drawn.
//!
//! Covered samples count before any depth test, overdraw included. In submission order the first of
//! them are drawn, triangle by triangle and row by row: the same ones on every adapter. In the
//! scheduler's order each sample takes a number from a counter: how many are drawn is exact, which
//! ones depends on the hardware.

use super::{BuiltIn, Effect, hooks::Slot, read};
use crate::{choice, words};

choice! {
    /// In which order samples are counted.
    pub enum Mode {
        /// In the order of the triangles; repeatable.
        Submission,
        /// In the order of the hardware, which differs from frame to frame.
        Scheduler,
    }
}

choice! {
    /// How the limit is given.
    pub enum Unit {
        /// A fraction of all samples.
        Fraction,
        /// A number of samples.
        Count,
    }
}

words! {
    pub struct DrawOrder of "draw_order" {
        first: [f32; 4],
        last: [f32; 4],
        mode: u32,
        unit: u32,
        limit: u32,
        fraction: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<DrawOrder>()
    .in_slot(Slot::Order)
    .repeatable_if(|words| Mode::of(read::<DrawOrder>(words).mode) == Mode::Submission)
    .into()
});

impl DrawOrder {
    /// Samples to draw of `total`.
    pub fn limit_of(&self, total: u64) -> u64 {
        match Unit::of(self.unit) {
            Unit::Count => total.min(self.limit.into()),
            Unit::Fraction => {
                let fraction =
                    (f64::from(self.fraction) * f64::from(1 << 24)).round_ties_even() as u128;
                ((u128::from(total) * fraction + (1 << 23)) >> 24) as u64
            }
        }
    }
}
