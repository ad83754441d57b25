//! Draw order: stops the picture after a number of samples, so that one sees the order in which it
//! is drawn.
//!
//! Covered samples count before any depth test, overdraw included. In submission order the first of
//! them are drawn, triangle by triangle and row by row: the same ones on every adapter. In the
//! scheduler's order each sample takes a number from a counter: how many are drawn is exact, which
//! ones depends on the hardware.

use glam::DVec4;

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput, hooks::Slot, read};
use crate::{choice, params, params::Color};

choice! {
    /// In which order samples are counted.
    pub enum Mode {
        /// In the order of the triangles; repeatable.
        Submission = "submission",
        /// In the order of the hardware, which differs from frame to frame.
        Scheduler = "scheduler",
    }
}

choice! {
    /// How the limit is given.
    pub enum Unit {
        /// A fraction of all samples.
        Fraction = "fraction",
        /// A number of samples.
        Count = "count",
    }
}

params! {
    pub struct DrawOrder {
        /// Color of what is drawn first; alpha is its weight against the surface's color.
        first: Color = [0.05, 0.1, 0.5, 0.0];
        /// Color of what is drawn last; alpha is its weight against the surface's color.
        last: Color = [1.0, 0.35, 0.05, 0.0];
        /// In which order samples are counted.
        mode: Mode = Mode::Submission as u32;
        /// How the limit is given.
        unit: Unit = Unit::Fraction as u32;
        /// Samples to draw.
        limit: u32 = 20000, soft 0.0..=200000.0, when ("unit", &["count"]);
        /// Fraction of all samples to draw.
        fraction: f32 = 0.5, hard 0.0..=1.0, when ("unit", &["fraction"]);
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<DrawOrder>(
        "draw_order",
        "DrawOrder",
        "stops the picture after a number of samples",
    )
    .in_slot(Slot::Order)
    .on_surface::<DrawOrder>()
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

impl SurfaceEffect for DrawOrder {
    const INPUTS: &[SurfaceInput] = &[SurfaceInput::Rank, SurfaceInput::Glow, SurfaceInput::Color];

    /// Heat by rank: the fraction of all samples that precede the triangle.
    fn apply(mut s: Surface, p: &Self) -> Surface {
        let [first, last] = [p.first, p.last].map(|color| DVec4::from_array(color.map(f64::from)));
        let heat = first.lerp(last, s.rank);
        s.glow *= 1.0 - heat.w;
        s.color = s
            .color
            .truncate()
            .lerp(heat.truncate(), heat.w)
            .extend(s.color.w);
        s
    }
}
