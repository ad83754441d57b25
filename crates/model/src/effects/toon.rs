//! Toon: light in a few flat steps with soft edges, and a rim.
//!
//! The brightest channel is the tone; its square root, which is about what the eye sees, falls into
//! steps of equal width. All channels are scaled alike, so hue and saturation stay.

use super::{
    BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput,
    hooks::tone::{rgb, smooth},
};
use crate::{params, params::Color};

params! {
    pub struct Toon {
        /// Color of the rim, linear; its alpha is the strength.
        rim: Color = [1.0, 0.96, 0.88, 0.0];
        /// Number of flat tones.
        steps: u32 = 3, hard 1.0..=16.0, soft 1.0..=8.0;
        /// Width of the edge between two tones, as a fraction of a step.
        softness: f32 = 0.12, hard 0.05..=1.0;
        /// Tone of the darkest step, as the eye sees it.
        shadow: f32 = 0.3, hard 0.0..=1.0;
        /// Tone of the brightest step.
        light: f32 = 0.95, hard 0.0..=1.0;
        /// How far the rim reaches in from the outline: 1 to where the surface faces the eye.
        rim_width: f32 = 0.35, hard 0.02..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Toon>(
        "toon",
        "Toon",
        "light in a few flat steps with soft edges, and a rim",
    )
    .in_steps()
    .into()
});

impl SurfaceEffect for Toon {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Color,
        SurfaceInput::Normal,
        SurfaceInput::View,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let (steps, softness) = (f64::from(p.steps), f64::from(p.softness));
        let base = s.color.truncate();
        let brightest = base.max_element().max(0.0);
        // The soft edge of a step is its upper end.
        let level = (brightest.sqrt().min(1.0) + s.step_offset).max(0.0) * steps;
        let step =
            (level.floor() + smooth(1.0 - softness, 1.0, level - level.floor())).min(steps - 1.0);
        let (shadow, light) = (f64::from(p.shadow), f64::from(p.light));
        let tone = light - (light - shadow) * (steps - 1.0 - step) / (steps - 1.0).max(1.0);
        let flat = if brightest > 1e-6 {
            base * (tone * tone / brightest)
        } else {
            glam::DVec3::splat(tone * tone)
        };
        let turned_away = 1.0 - s.normal.dot(s.view).clamp(0.0, 1.0);
        let inner = 1.0 - f64::from(p.rim_width);
        let rim = smooth(inner, inner + 0.5 * softness, turned_away) * f64::from(p.rim[3]);
        s.color = (flat + (rgb(p.rim) - flat) * rim).extend(s.color.w);
        s
    }
}
