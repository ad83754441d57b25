//! Wireframe: draws the edges of triangles at a constant width in pixels.
//!
//! A sample lies within w of an edge of length l when its doubled area with the edge is at most
//! w·l: one integer is compared with another, which is computed once per triangle. Edges that
//! clipping added are not drawn.

use super::{
    BuiltIn, Effect, 
    hooks::{Sample, SampleEffect, TriangleSetup},
};
use crate::{choice, words};

choice! {
    /// What becomes of lines behind faces.
    pub enum Hidden {
        /// Faces are empty, so lines behind them show.
        Shown,
        /// Faces are filled and hide them.
        Removed,
    }
}

words! {
    pub struct Wireframe of "wireframe" {
        ink: [f32; 4],
        paper: [f32; 4],
        width_px: f32,
        hidden: u32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Wireframe>()
    .on_sample::<Wireframe>()
    .into()
});

impl SampleEffect for Wireframe {
    const HAS_SETUP: bool = true;

    /// How near the edge opposite each corner a sample must be, less one; 0 never. Each triangle
    /// draws half of a width.
    fn sample_setup(setup: &TriangleSetup, p: &Self, first: Option<u32>) -> [u32; 4] {
        let half_width = (f64::from(p.width_px) * 128.0).round_ties_even() as u64;
        let reach = |k: usize| match setup.outline >> k & 1 {
            0 => 0,
            _ => {
                ((setup.squared_length(k).isqrt() * half_width) >> setup.shift()).min(0x7fff_ffff)
                    as u32
                    + 1
            }
        };
        [first.unwrap_or(reach(0)), reach(1), reach(2), 0]
    }

    fn is_drawn(s: &Sample, p: &Self) -> bool {
        Hidden::of(p.hidden) == Hidden::Removed || (0..3).any(|k| s.areas[k] < s.setup[k])
    }
}
