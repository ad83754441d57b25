//! Smear: where nothing is drawn, the previous picture remains and fades towards the background.
//!
//! Whole bytes fade by whole steps, so that a trail is the same on every adapter. A single picture
//! follows `frames` earlier ones, `step_s` apart, the first of which follows plain background; the
//! window, while time runs, uses the pictures that it showed.

use glam::DVec4;

use super::{
    BuiltIn, Effect,
    hooks::{ImageEffect, Picture, Pixel},
};
use crate::params;

params! {
    pub struct Smear {
        /// Fraction of the difference to the background that a trail loses from one picture to the next: 1 leaves no trail, 0 never fades.
        fade: f32 = 0.12, hard 0.0..=1.0, soft 0.0..=0.5;
        /// Earlier pictures that are drawn before a single one.
        frames: u32 = 12, hard 0.0..=32.0;
        /// Time from one of them to the next.
        step_s: f32 = 0.04, hard 0.0..=60.0, soft 0.01..=0.5, unit "s";
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Smear>(
        "smear",
        "Smear",
        "where nothing is drawn the picture before stays, and fades",
    )
    .on_image::<Smear>()
    .into()
});

impl ImageEffect for Smear {
    const READS_PREVIOUS: bool = true;

    fn finish(mut pixel: Pixel, picture: &Picture, p: &Self) -> Pixel {
        let (triangle_id, ..) = picture.at(pixel.x.into(), pixel.y.into());
        if triangle_id.is_some() {
            return pixel;
        }
        let background = picture.background[pixel.y as usize].map(i64::from);
        let index = pixel.y as usize * picture.width as usize + pixel.x as usize;
        let previous = picture
            .previous
            .map_or(background, |previous| previous[index].map(i64::from));
        // In units of 2^-16; a trail that fades takes at least one step, so it ends.
        let step = (f64::from(p.fade) * 65536.0) as i64;
        let faded = |c: usize| {
            let gap = background[c] - previous[c];
            previous[c] + gap.signum() * ((gap.abs() * step + 65535) >> 16)
        };
        pixel.color = DVec4::from_array([0, 1, 2, 3].map(|c| faded(c) as f64 / 255.0));
        pixel
    }
}
