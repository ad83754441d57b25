//! Vignette: the picture darkens towards its corners, as through a lens.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec4;

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect, tone::{rgb, smooth}},
};
use crate::{params, params::Color};

params! {
    pub struct Vignette {
        /// What the corners turn to, linear; its alpha is the strength.
        color: Color = [0.0, 0.0, 0.0, 1.0];
        /// How far the corners turn to it: 1 entirely.
        amount: f32 = 0.7, hard 0.0..=1.0;
        /// Where it begins, from the middle of the picture at 0 to its corners at 1.
        reach: f32 = 0.35, hard 0.0..=0.99;
        /// 0: an ellipse in the shape of the picture, 1: a circle.
        roundness: f32 = 0.5, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Vignette>(
        "vignette",
        "Vignette",
        "the picture darkens towards its corners",
    )
    .on_passes::<Vignette>()
    .into()
});

impl PassEffect for Vignette {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let size = at.picture_size();
        let from_middle = (at.middle() - 0.5 * size).abs();
        let round = (from_middle / (0.5 * size.length())).length();
        let shaped = (from_middle / (size * FRAC_1_SQRT_2)).length();
        let away = shaped + (round - shaped) * f64::from(p.roundness);
        let dark = f64::from(p.amount) * f64::from(p.color[3]) * smooth(f64::from(p.reach), 1.0, away);
        let color = at.color(at.x, at.y);
        let seen = color.truncate();
        (seen + (rgb(p.color) - seen) * dark).extend(color.w)
    }
}
