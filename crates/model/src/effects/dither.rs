//! Dither: ordered dithering (Bayer 1973), so that few levels look like many.
//!
//! A threshold from a matrix that tiles the picture decides between the two nearest levels; over a
//! tile the mean is the value. With 256 levels it hides the banding of soft gradients.

use super::{
    BuiltIn, Effect,
    hooks::{
        ImageEffect, Picture, Pixel,
        tone::{self, bayer_rank},
    },
};
use crate::{choice, params, params::Color};

choice! {
    /// Size of the matrix.
    pub enum Matrix {
        /// 8 by 8: 64 thresholds.
        Bayer8 = "bayer8",
        /// 4 by 4: 16 thresholds.
        Bayer4 = "bayer4",
        /// 2 by 2: 4 thresholds.
        Bayer2 = "bayer2",
    }
}

choice! {
    /// Which colors the levels have.
    pub enum Palette {
        /// Red, green and blue have levels each for themselves.
        Rgb = "rgb",
        /// From one color to another, by luminance.
        Duotone = "duotone",
    }
}

params! {
    pub struct Dither {
        /// Color of the lowest level, linear.
        ink: Color = [0.02, 0.03, 0.05, 1.0], when ("palette", &["duotone"]);
        /// Color of the highest level, linear.
        paper: Color = [0.8, 0.82, 0.7, 1.0], when ("palette", &["duotone"]);
        /// Number of levels, lowest and highest included.
        levels: u32 = 256, hard 2.0..=256.0;
        /// Which colors the levels have.
        palette: Palette = Palette::Rgb as u32;
        /// Size of the matrix.
        matrix: Matrix = Matrix::Bayer8 as u32;
        /// Side of a cell of the matrix.
        cell_px: u32 = 1, hard 1.0..=1024.0, soft 1.0..=8.0, unit "px";
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Dither>(
        "dither",
        "Dither",
        "ordered dithering, so that few levels look like many",
    )
    .on_image::<Dither>()
    .in_steps()
    .into()
});

impl ImageEffect for Dither {
    fn finish(mut pixel: Pixel, _: &Picture, p: &Self) -> Pixel {
        let bits = match Matrix::of(p.matrix) {
            Matrix::Bayer8 => 3,
            Matrix::Bayer4 => 2,
            Matrix::Bayer2 => 1,
        };
        let threshold = (f64::from(bayer_rank(pixel.x / p.cell_px, pixel.y / p.cell_px, bits)) + 0.5)
            / f64::from(1 << (2 * bits));
        let last = f64::from(p.levels - 1);
        let level = |value: f64| {
            (((value + pixel.step_offset) * last + threshold).floor() / last).clamp(0.0, 1.0)
        };
        let base = pixel.color.truncate();
        let color = match Palette::of(p.palette) {
            Palette::Rgb => base.map(level),
            Palette::Duotone => {
                let (ink, paper) = (
                    tone::encoded(p.ink).truncate(),
                    tone::encoded(p.paper).truncate(),
                );
                ink + (paper - ink) * level(tone::luminance(base))
            }
        };
        pixel.color = color.extend(pixel.color.w);
        pixel
    }
}
