//! CRT: a curved screen with scan lines and stripes of red, green and blue phosphor.

use glam::{DVec2, DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect, tone::turned},
};
use crate::params;

params! {
    pub struct Crt {
        /// How much the screen bulges: 0 is flat.
        curve: f32 = 0.07, hard 0.0..=1.0, soft 0.0..=0.4;
        /// How dark it is between scan lines.
        lines: f32 = 0.6, hard 0.0..=1.0;
        /// Distance of scan lines.
        line_px: f32 = 3.0, hard 1.0..=64.0, soft 2.0..=12.0, unit "px";
        /// How much light of other colors the stripes of phosphor keep back.
        mask: f32 = 0.35, hard 0.0..=1.0;
        /// Width of a red, a green and a blue stripe together.
        mask_px: u32 = 3, hard 3.0..=96.0, soft 3.0..=24.0, unit "px";
        /// How far the beam spreads along a line.
        soft_px: f32 = 0.8, hard 0.0..=32.0, soft 0.0..=4.0, unit "px";
        /// Brightness, which makes up for lines and stripes.
        gain: f32 = 1.6, hard 0.0..=8.0, soft 0.5..=3.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Crt>("crt", "Crt", "a curved screen with scan lines and phosphor stripes")
        .on_passes::<Crt>()
        .into()
});

impl PassEffect for Crt {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let size = at.picture_size();
        let flat = (at.middle() - 0.5 * size) / (0.5 * size);
        let across = DVec2::new(flat.y, flat.x);
        let bent = flat * (1.0 + f64::from(p.curve) * across * across);
        let place = (0.5 + 0.5 * bent) * size;
        // The beam is wide, across the lines.
        let read = |right: f64| at.color_at(place + DVec2::new(right, 0.0)).truncate();
        let soft = f64::from(p.soft_px);
        let light = 0.5 * read(0.0) + 0.25 * read(-soft) + 0.25 * read(soft);
        let beam = 0.5 - 0.5 * turned(360.0 * (place.y / f64::from(p.line_px))).x;
        let stripe = (at.x as u32 * 3 / p.mask_px % 3) as usize;
        let mut phosphor = DVec3::splat(1.0 - f64::from(p.mask));
        phosphor[stripe] = 1.0;
        // The rim of the screen, a pixel wide.
        let rim = (1.0 - bent.abs()) * 0.5 * size + 0.5;
        let inside = rim.clamp(DVec2::ZERO, DVec2::ONE);
        let dark = f64::from(p.lines) * (1.0 - beam);
        let shown = f64::from(p.gain) * inside.x * inside.y * (1.0 - dark);
        (light * phosphor * shown).extend(at.color(at.x, at.y).w)
    }
}
