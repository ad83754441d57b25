//! Sharpen: what differs from its surroundings differs more.

use glam::{DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect},
};
use crate::params;

params! {
    pub struct Sharpen {
        /// Strength: 1 doubles the difference.
        amount: f32 = 0.8, hard 0.0..=8.0, soft 0.0..=3.0;
        /// Distance of the pixels that count as surroundings.
        radius_px: u32 = 1, hard 1.0..=64.0, soft 1.0..=8.0, unit "px";
        /// How far edges may rise above and fall below their surroundings: 0 leaves no halo.
        halo: f32 = 0.1, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Sharpen>("sharpen", "Sharpen", "edges stand out, without halos")
        .on_passes::<Sharpen>()
        .into()
});

impl PassEffect for Sharpen {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let color = at.color(at.x, at.y);
        let step = i64::from(p.radius_px);
        let here = tone(color);
        let (mut mean, mut least, mut most) = (DVec3::ZERO, here, here);
        for down in -1..=1_i64 {
            for right in -1..=1_i64 {
                let tone = tone(at.color(at.x + right * step, at.y + down * step));
                // 1 2 1 across and down.
                mean += tone * ((2 - right.abs()) * (2 - down.abs())) as f64;
                (least, most) = (least.min(tone), most.max(tone));
            }
        }
        let sharp = here + f64::from(p.amount) * (here - mean / 16.0);
        let room = f64::from(p.halo) * (most - least);
        let held = sharp.clamp((least - room).max(DVec3::ZERO), most + room);
        (held * held).extend(color.w)
    }
}

/// Square roots are about what the eye sees.
fn tone(color: DVec4) -> DVec3 {
    color.truncate().max(DVec3::ZERO).map(f64::sqrt)
}
