//! Pixelate: large square pixels, each of one color.

use glam::DVec4;

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect},
};
use crate::params;

params! {
    pub struct Pixelate {
        /// Side of a square.
        size_px: u32 = 5, hard 1.0..=512.0, soft 2.0..=32.0, unit "px";
        /// How dark the lines between the squares are.
        gap: f32 = 0.15, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Pixelate>("pixelate", "Pixelate", "large square pixels")
        .on_passes::<Pixelate>()
        .into()
});

impl PassEffect for Pixelate {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let size = i64::from(p.size_px);
        let first = [at.x, at.y].map(|place| place / size * size);
        // Of a large square, pixels on a grid of 8 by 8 are enough.
        let steps = size.min(8);
        let within = |step: i64| (2 * step + 1) * size / (2 * steps);
        let mut sum = DVec4::ZERO;
        for down in 0..steps {
            for right in 0..steps {
                sum += at.color(first[0] + within(right), first[1] + within(down));
            }
        }
        let mean = sum / (steps * steps) as f64;
        let is_gap = at.x == first[0] || at.y == first[1];
        let light = if is_gap { 1.0 - f64::from(p.gap) } else { 1.0 };
        (mean.truncate() * light).extend(mean.w)
    }
}
