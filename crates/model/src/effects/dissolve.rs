//! Dissolve: fills every triangle to a fraction of its area, exactly, and lets a front travel over
//! the model.
//!
//! Sweeps are of equal area: from an edge the filled part reaches 1 - √(1 - p) of the height, from
//! a corner or the centroid √p of the way, so that p per cent mean p per cent. Integers decide,
//! sample by sample.

use glam::{DVec2, DVec3};

use super::{
    BuiltIn, Effect, 
    hooks::{Front, Pattern, Sample, SampleEffect, TriangleSetup},
};
use crate::{choice, math::hash, words};

choice! {
    /// How a triangle fills.
    pub enum Mode {
        /// From the edge opposite the corner.
        Edge,
        /// From the corner.
        Corner,
        /// From the middle.
        Centroid,
        /// Row by row, left to right.
        Scanline,
        /// Pixel by pixel, at random.
        Hash,
    }
}

words! {
    pub struct Dissolve of "dissolve" {
        rim: [f32; 4],
        fill: f32,
        mode: u32,
        corner: u32,
        rim_width: f32,
        spread: Front,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Dissolve>()
    .on_sample::<Dissolve>()
    .into()
});

/// The whole triangle, in units of the fractions.
const ONE: u32 = 1 << 24;
/// In the third word of a decision: the hash tells.
const BY_HASH: u32 = 1;

impl Dissolve {
    fn fill_of(&self, center: DVec3, center_screen: DVec2, triangle: u32) -> f64 {
        if self.spread.pattern() == Pattern::Uniform {
            return self.fill.into();
        }
        1.0 - (1.0 - f64::from(self.fill)) * self.spread.reached(center, center_screen, triangle)
    }
}

/// round(√(fraction / 2^24) · 2^16); 65,537, beyond every path, where the fraction is 1.
fn root(fraction: u32) -> u32 {
    if fraction >= ONE {
        return 65_537;
    }
    let n = fraction << 8;
    let root = n.isqrt();
    root + u32::from(n - root * root > root)
}

impl SampleEffect for Dissolve {
    const HAS_SETUP: bool = true;

    fn error_bound(setup: &TriangleSetup, p: &Self) -> f64 {
        if p.spread.pattern() == Pattern::Uniform {
            return 0.0;
        }
        let error_bound = p.spread.error_bound(
            setup.center,
            setup.center_screen,
            setup.triangle,
            &setup.error_bound(),
        );
        error_bound * f64::from(ONE) + 2.0
    }

    fn is_from_floats(p: &Self) -> bool {
        p.spread.pattern() != Pattern::Uniform
    }

    fn sample_setup(setup: &TriangleSetup, p: &Self, first: Option<u32>) -> [u32; 4] {
        let fill = p
            .fill_of(setup.center, setup.center_screen, setup.triangle)
            .clamp(0.0, 1.0);
        let fraction = first.unwrap_or((fill * f64::from(ONE)).round_ties_even() as u32);
        let mode = Mode::of(p.mode);
        let samples = if mode == Mode::Hash {
            0
        } else {
            setup
                .samples()
                .take(if mode == Mode::Scanline {
                    usize::MAX
                } else {
                    2
                })
                .count()
        };
        if samples < 2 {
            return [fraction, 0, BY_HASH, 0];
        }
        let threshold = match mode {
            Mode::Edge if fraction == ONE => 65_537,
            Mode::Edge => 65_536 - root(ONE - fraction).min(65_536),
            Mode::Corner | Mode::Centroid => root(fraction),
            Mode::Scanline => {
                let sample_count = (u64::from(fraction) * samples as u64 + (1 << 23)) >> 24;
                setup
                    .samples()
                    .nth(sample_count as usize)
                    .map_or(u32::MAX, |[x, y]| y << 16 | x)
            }
            Mode::Hash => unreachable!("it took the hash"),
        };
        [fraction, threshold, 0, 0]
    }

    fn is_drawn(s: &Sample, p: &Self) -> bool {
        let pixel = s.y << 16 | s.x;
        let [fraction, threshold, kind, _] = s.setup;
        if kind == BY_HASH {
            return hash(hash(s.triangle ^ p.spread.seed) ^ pixel) >> 8 < fraction;
        }
        let (whole, part) = (s.total_area(), s.areas[p.corner.min(2) as usize]);
        let way = match Mode::of(p.mode) {
            Mode::Edge => part,
            Mode::Corner => whole.wrapping_sub(part),
            Mode::Centroid => whole.wrapping_sub(s.areas.iter().min().expect("three areas") * 3),
            Mode::Scanline | Mode::Hash => return pixel < threshold,
        };
        u64::from(way) << 16 < u64::from(threshold) * u64::from(whole)
    }
}
