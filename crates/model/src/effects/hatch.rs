//! Hatch: cross-hatching in ink, whose lines grow as the tone darkens.
//!
//! Layers of parallel lines appear one after the other; each line is filtered over its pixel, so
//! that nothing flickers. Lines lie in the picture, or are cuts of parallel planes through the
//! world, as an engraver follows the form. Those on a triangle that the near plane cuts waver by a
//! fraction of a pixel: there f32 resolves positions to 1e-5 of their distance.

use glam::DVec3;

use super::{
    BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput,
    hooks::tone::{luminance, rgb, turned},
};
use crate::{choice, params, params::Color};

choice! {
    /// The space in which the lines are drawn.
    pub enum LineSpace {
        /// In the picture.
        Screen = "screen",
        /// On the surface, as cuts of planes through the world.
        Surface = "surface",
    }
}

params! {
    pub struct Hatch {
        /// Color of the lines, linear.
        ink: Color = [0.012, 0.014, 0.03, 1.0];
        /// Color between the lines, linear.
        paper: Color = [0.86, 0.82, 0.72, 1.0];
        /// The space in which the lines are drawn.
        space: LineSpace = LineSpace::Screen as u32;
        /// Distance of two lines in the picture.
        spacing_px: f32 = 6.0, hard 0.25..=1024.0, soft 3.0..=24.0, unit "px", when ("space", &["screen"]);
        /// Distance of two planes.
        spacing_m: f32 = 0.06, hard 0.001..=1e3, soft 0.01..=0.5, unit "m", log true, when ("space", &["surface"]);
        /// Direction of the first layer; the second crosses it, two more lie between.
        angle_deg: f32 = 35.0, hard -360.0..=360.0, soft -90.0..=90.0, unit "°";
        /// Layers that appear one after the other.
        layers: u32 = 3, hard 1.0..=4.0;
        /// Width of a full line, as a fraction of the spacing.
        width: f32 = 0.55, hard 0.05..=1.0;
        /// Tone at which every layer is full, as the eye sees it.
        dark: f32 = 0.05, hard 0.0..=1.0;
        /// Tone from which the paper stays bare.
        bright: f32 = 0.9, hard 0.0..=1.0;
        /// How much of the surface's hue the paper takes on.
        tint: f32 = 0.0, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Hatch>(
        "hatch",
        "Hatch",
        "cross-hatching in ink, whose lines grow as the tone darkens",
    )
    .into()
});

impl SurfaceEffect for Hatch {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Color,
        SurfaceInput::Pixel,
        SurfaceInput::Normal,
        SurfaceInput::View,
        SurfaceInput::PixelSize,
        SurfaceInput::Position,
        SurfaceInput::Depth,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let base = s.color.truncate().max(DVec3::ZERO);
        let tone = luminance(base).sqrt().min(1.0) + s.step_offset;
        let (dark, bright) = (f64::from(p.dark), f64::from(p.bright));
        let darkness = 1.0 - ((tone - dark) / (bright - dark).max(0.2)).clamp(0.0, 1.0);
        let mut bare = 1.0;
        for layer in 0..p.layers {
            let width = (darkness * f64::from(p.layers) - f64::from(layer)).clamp(0.0, 1.0)
                * f64::from(p.width);
            bare *= 1.0 - p.line(&s, layer, width);
        }
        let paper = rgb(p.paper);
        let hue = if base.max_element() > 1e-6 {
            base / base.max_element()
        } else {
            DVec3::ONE
        };
        let paper = paper + (paper * hue - paper) * f64::from(p.tint);
        // Mixed as the eye sees it, as the tone was taken: in linear light a trace of paper would
        // outshine the ink.
        let (ink, paper) = (rgb(p.ink).map(f64::sqrt), paper.map(f64::sqrt));
        let mixed = ink + (paper - ink) * bare;
        s.color = (mixed * mixed).extend(s.color.w);
        s
    }
}

impl Hatch {
    /// Coverage of the pixel by the lines of a layer, which are `width` of their spacing wide.
    fn line(&self, s: &Surface, layer: u32, width: f64) -> f64 {
        // Crossed, then between.
        let along =
            turned(f64::from(self.angle_deg) + [0.0, 90.0, 45.0, 135.0][layer as usize & 3]);
        let (position, spacing_px) = match LineSpace::of(self.space) {
            LineSpace::Screen => (
                (s.pixel.y * along.x - s.pixel.x * along.y) / f64::from(self.spacing_px),
                f64::from(self.spacing_px),
            ),
            LineSpace::Surface => {
                let across =
                    DVec3::new(-along.y, along.x, if layer < 2 { 0.0 } else { 1.0 }).normalize();
                // How far the planes' distance changes from pixel to pixel; clamped where the
                // surface lies along the planes or is seen edge-on, and where f32
                // resolves no finer positions in the world.
                let change =
                    across - s.normal * (across.dot(s.view) / s.normal.dot(s.view).max(0.1));
                let per_px = (s.pixel_size_m * change.length().max(0.4))
                    .max(1.5e-4 * (s.position.length() + s.depth_m));
                (
                    s.position.dot(across) / f64::from(self.spacing_m),
                    f64::from(self.spacing_m) / per_px,
                )
            }
        };
        // A position on a surface errs by a few thousandths of a pixel.
        let distance =
            (position - position.floor() - 0.5).abs() * spacing_px + 64.0 * s.step_offset;
        let half = 0.5 * width * spacing_px;
        let covered = ((distance + 0.5).min(half) - (distance - 0.5).max(-half)).clamp(0.0, 1.0);
        // Lines too dense for the pixels become their mean.
        width + (covered - width) * (spacing_px - 1.0).clamp(0.0, 1.0)
    }
}
