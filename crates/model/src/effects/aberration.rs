//! Aberration: colors part towards the edges of the picture, as through a simple lens.

use glam::{DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect},
};
use crate::params;

params! {
    pub struct Aberration {
        /// How far red and blue light part in the corners, each way.
        shift_px: f32 = 7.0, hard 0.0..=128.0, soft 0.0..=32.0, unit "px";
        /// 0: evenly from the middle on, 1: mostly at the edges.
        edges: f32 = 0.6, hard 0.0..=1.0;
    }
}

/// Reads to either side of the middle.
const TAPS: i32 = 4;

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Aberration>(
        "aberration",
        "Aberration",
        "colors part towards the edges, as through a simple lens",
    )
    .on_passes::<Aberration>()
    .into()
});

impl PassEffect for Aberration {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let (size, middle) = (at.picture_size(), at.middle());
        let away = (middle - 0.5 * size) / (0.5 * size.length());
        let growth = 1.0 + (away.length() - 1.0) * f64::from(p.edges);
        let shift = away * (f64::from(p.shift_px) * growth);
        let (mut sum, mut weights) = (DVec3::ZERO, DVec3::ZERO);
        for i in -TAPS..=TAPS {
            let t = f64::from(i) / f64::from(TAPS);
            // Red light comes from farther out, blue light from farther in.
            let weight = (1.0 - 2.0 * DVec3::new(t - 0.5, t, t + 0.5).abs()).max(DVec3::ZERO);
            sum += weight * at.color_at(middle + t * shift).truncate();
            weights += weight;
        }
        (sum / weights).extend(at.color(at.x, at.y).w)
    }
}
