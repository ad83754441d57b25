//! Grain: the noise of a photographic film, strongest in the middle tones.

use glam::{DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect, tone::luminance},
};
use crate::{
    math::{HASH_GOLDEN, hash, hash_unit},
    params,
};

params! {
    pub struct Grain {
        /// Strength of the noise.
        amount: f32 = 0.35, hard 0.0..=1.0;
        /// How far red, green and blue have noise of their own.
        color: f32 = 0.25, hard 0.0..=1.0;
        /// Size of a grain.
        size_px: u32 = 1, hard 1.0..=64.0, soft 1.0..=8.0, unit "px";
        /// Another seed gives other noise.
        seed: u32 = 0, hard 0.0..=65535.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Grain>("grain", "Grain", "the noise of a photographic film")
        .on_passes::<Grain>()
        .into()
});

impl PassEffect for Grain {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let [x, y] = [at.x, at.y].map(|place| (place / i64::from(p.size_px)) as u32);
        let row = hash(x.wrapping_add(p.seed.wrapping_mul(HASH_GOLDEN)));
        let seed = hash(row.wrapping_add(y));
        let gray = DVec3::splat(noise(seed));
        let own = DVec3::from([1, 2, 3].map(|channel| noise(seed.wrapping_add(channel))));
        let noise = gray + (own - gray) * f64::from(p.color);
        let color = at.color(at.x, at.y);
        let light = color.truncate();
        // Square roots are about what the eye sees.
        let tone = light.clamp(DVec3::ZERO, DVec3::ONE).map(f64::sqrt);
        let middle = luminance(light).clamp(0.0, 1.0).sqrt();
        let strength = f64::from(p.amount) * (0.25 + 3.0 * middle * (1.0 - middle));
        let grained = (tone + strength * noise).clamp(DVec3::ZERO, DVec3::ONE);
        (grained * grained).extend(color.w)
    }
}

/// A sum of three numbers, about normally distributed, -1/2 to 1/2.
fn noise(seed: u32) -> f64 {
    let sum = hash_unit(seed) + hash_unit(seed ^ 0x5555_5555) + hash_unit(seed ^ 0x3333_3333);
    sum / 3.0 - 0.5
}
