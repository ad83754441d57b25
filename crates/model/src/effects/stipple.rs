//! Stipple: screen-door transparency by an ordered integer matrix.

use super::{
    BuiltIn, Effect,
    hooks::{Sample, SampleEffect, TriangleSetup},
};
use crate::{choice, math::hash, params, params::Flag};

choice! {
    /// Cells of the matrix, which has as many levels.
    pub enum Matrix {
        /// 4 levels.
        Two = "2x2",
        /// 16 levels.
        Four = "4x4",
        /// 64 levels.
        Eight = "8x8",
    }
}

params! {
    pub struct Stipple {
        /// Fraction of the samples that are drawn.
        opacity: f32 = 0.5, hard 0.0..=1.0;
        /// Matrix whose order the samples follow: the larger, the more levels.
        matrix: Matrix = Matrix::Eight as u32;
        /// Side of one cell of the matrix.
        cell_px: u32 = 1, hard 1.0..=1024.0, soft 1.0..=8.0, unit "px";
        /// Shifts the matrix from triangle to triangle, so that layers do not hide behind each other.
        shift_per_triangle: Flag = 0;
        /// Seed of the shifts.
        seed: u32 = 1, soft 0.0..=999.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Stipple>(
        "stipple",
        "Stipple",
        "screen-door transparency by an ordered matrix",
    )
    .on_sample::<Stipple>()
    .into()
});

impl SampleEffect for Stipple {
    const HAS_SETUP: bool = false;

    fn sample_setup(_: &TriangleSetup, _: &Self, _: Option<u32>) -> [u32; 4] {
        [0; 4]
    }

    fn is_drawn(s: &Sample, p: &Self) -> bool {
        let bits = p.matrix.min(2) + 1;
        let shift = if p.shift_per_triangle == 0 {
            0
        } else {
            hash(s.triangle ^ p.seed)
        };
        let x = s.x / p.cell_px.max(1) + (shift & 7);
        let y = s.y / p.cell_px.max(1) + (shift >> 3 & 7);
        // Bayer (1973): bits of x xor y and of y interleaved, the lowest first.
        let rank = (0..bits).fold(0, |rank, i| {
            rank << 2 | ((x ^ y) >> i & 1) << 1 | (y >> i & 1)
        });
        let level = (f64::from(p.opacity) * f64::from(1u32 << (2 * bits))).round_ties_even() as u32;
        rank < level
    }
}
