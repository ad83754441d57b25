//! Bloom: bright places shine over their surroundings.

use glam::{DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{
        ImageAt, PassEffect,
        tone::{rgb, smooth},
    },
};
use crate::{params, params::Color};

params! {
    pub struct Bloom {
        /// Color of the light, linear; its alpha is the strength.
        tint: Color = [1.0, 0.93, 0.82, 1.0];
        /// Brightness from which a place shines, linear.
        threshold: f32 = 0.4, hard 0.0..=1.0;
        /// How far above it a place shines entirely.
        knee: f32 = 0.35, hard 0.01..=1.0;
        /// How far the light reaches.
        radius_px: f32 = 36.0, hard 1.0..=512.0, soft 1.0..=96.0, unit "px";
        /// Strength of the light.
        intensity: f32 = 1.4, hard 0.0..=16.0, soft 0.0..=4.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Bloom>("bloom", "Bloom", "bright places shine over their surroundings")
        .on_passes::<Bloom>()
        .into()
});

impl PassEffect for Bloom {
    const PASSES: &'static [(&'static str, u32)] =
        &[("bright", 2), ("across", 2), ("down", 2), ("screen", 1)];

    fn pass(index: usize, at: &ImageAt, p: &Self) -> DVec4 {
        match index {
            0 => p.bright(at),
            1 => mean_along(at, [1, 0], 0.5 * f64::from(p.radius_px)),
            2 => mean_along(at, [0, 1], 0.5 * f64::from(p.radius_px)),
            _ => p.screen(at),
        }
    }
}

impl Bloom {
    /// What shines, at half the size.
    fn bright(&self, at: &ImageAt) -> DVec4 {
        let color = at.color_at(at.middle());
        let light = color.truncate();
        let past = (light.max_element() - f64::from(self.threshold)) / f64::from(self.knee);
        (light * smooth(0.0, 1.0, past)).extend(color.w)
    }

    /// Light over light, as two projectors screen it.
    fn screen(&self, at: &ImageAt) -> DVec4 {
        let color = at.color(at.x, at.y);
        let (light, strength) = (color.truncate(), self.intensity_of_tint());
        let shine = strength * rgb(self.tint) * at.last_at(0.5 * at.middle()).truncate();
        (light + shine * (1.0 - light.clamp(DVec3::ZERO, DVec3::ONE))).extend(color.w)
    }

    fn intensity_of_tint(&self) -> f64 {
        f64::from(self.intensity) * f64::from(self.tint[3])
    }
}

/// Weighted mean of what the last pass wrote along a direction: a sharp core in a wide halo.
fn mean_along(at: &ImageAt, along: [i64; 2], radius: f64) -> DVec4 {
    let reach = radius.ceil() as i64;
    let (mut sum, mut weights) = (DVec4::ZERO, 0.0);
    for i in -reach..=reach {
        let t = i as f64 / (radius + 1.0);
        let near = (1.0 - t.abs()).max(0.0);
        let weight = near * near * near;
        sum += weight * at.last(at.x + i * along[0], at.y + i * along[1]);
        weights += weight;
    }
    sum / weights
}
