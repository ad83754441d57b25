//! Posterize: few levels of color, evenly spaced to the eye.

use super::{
    BuiltIn, Effect,
    hooks::{ImageEffect, Picture, Pixel},
};
use crate::{choice, params};

choice! {
    /// What is quantized.
    pub enum By {
        /// Red, green and blue, each separately.
        Channels = "channels",
        /// The brightest channel; the others keep their ratio to it, so hue stays.
        Brightness = "brightness",
    }
}

params! {
    pub struct Posterize {
        /// What is quantized.
        by: By = By::Channels as u32;
        /// Number of levels, black and white included.
        levels: u32 = 5, hard 2.0..=256.0, soft 2.0..=16.0;
        /// How far colors move to their level: 0 not at all, 1 entirely.
        amount: f32 = 1.0, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Posterize>(
        "posterize",
        "Posterize",
        "few levels of color, evenly spaced to the eye",
    )
    .on_image::<Posterize>()
    .in_steps()
    .into()
});

impl ImageEffect for Posterize {
    fn finish(mut pixel: Pixel, _: &Picture, p: &Self) -> Pixel {
        let last = f64::from(p.levels - 1);
        let level = |value: f64| {
            (((value + pixel.step_offset) * last + 0.5).floor() / last).clamp(0.0, 1.0)
        };
        let base = pixel.color.truncate();
        let flat = match By::of(p.by) {
            By::Channels => base.map(level),
            By::Brightness => base * (level(base.max_element()) / base.max_element().max(1e-6)),
        };
        pixel.color = (base + (flat - base) * f64::from(p.amount)).extend(pixel.color.w);
        pixel
    }
}
