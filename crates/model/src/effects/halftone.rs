//! Halftone: dots of ink on paper, large where the picture is dark.

use glam::{DVec2, DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{
        ImageAt, PassEffect,
        tone::{luminance, rgb, turned},
    },
};
use crate::{choice, params, params::Color};

choice! {
    /// With which inks the picture is printed.
    pub enum Inks {
        /// Cyan, magenta, yellow and black.
        Four = "four",
        /// One ink.
        One = "one",
    }
}

params! {
    pub struct Halftone {
        /// Color of the one ink, linear; its alpha is how well it covers.
        ink: Color = [0.02, 0.03, 0.06, 1.0], when ("inks", &["one"]);
        /// Color of the paper, linear.
        paper: Color = [0.93, 0.89, 0.8, 1.0];
        /// With which inks the picture is printed.
        inks: Inks = Inks::Four as u32;
        /// Distance of dots.
        cell_px: f32 = 5.0, hard 2.0..=256.0, soft 3.0..=32.0, unit "px";
        /// Turns all screens.
        angle_deg: f32 = 0.0, hard -180.0..=180.0, soft -90.0..=90.0, unit "°";
        /// How much of what all colors have in common is printed black.
        black: f32 = 0.7, hard 0.0..=1.0, when ("inks", &["four"]);
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Halftone>(
        "halftone",
        "Halftone",
        "dots of ink on paper, large where it is dark",
    )
    .on_passes::<Halftone>()
    .into()
});

impl PassEffect for Halftone {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let color = at.color(at.x, at.y);
        let light = color.truncate().clamp(DVec3::ZERO, DVec3::ONE);
        let screen = |degrees: f64, tone: f64| p.screen(at.middle(), degrees, tone);
        if Inks::of(p.inks) == Inks::One {
            let covered = screen(45.0, 1.0 - luminance(light)) * f64::from(p.ink[3]);
            return (rgb(p.paper) + (rgb(p.ink) - rgb(p.paper)) * covered).extend(color.w);
        }
        let key = f64::from(p.black) * (1.0 - light.max_element());
        let rest = (1.0 - key).max(0.001);
        let tones = ((rest - light) / rest).clamp(DVec3::ZERO, DVec3::ONE);
        // What each ink keeps of the light.
        let printed = [
            (screen(15.0, tones.x), DVec3::new(1.0, 0.32, 0.08)),
            (screen(75.0, tones.y), DVec3::new(0.12, 1.0, 0.5)),
            (screen(0.0, tones.z), DVec3::new(0.02, 0.1, 1.0)),
            (screen(45.0, key), DVec3::new(0.98, 0.98, 0.97)),
        ]
        .into_iter()
        .fold(rgb(p.paper), |light, (covered, kept)| {
            light * (1.0 - covered * kept)
        });
        printed.extend(color.w)
    }
}

impl Halftone {
    /// How much of a pixel the dots of a screen at this angle cover, given the fraction that they
    /// cover together.
    fn screen(&self, place: DVec2, degrees: f64, tone: f64) -> f64 {
        let cell_px = f64::from(self.cell_px);
        let along = turned(degrees + f64::from(self.angle_deg));
        let cell = DVec2::new(place.dot(along), place.dot(DVec2::new(-along.y, along.x)));
        let wave = |place: f64| turned(360.0 * (place / cell_px)).x;
        let height = 0.5 + 0.25 * (wave(cell.x) + wave(cell.y));
        // Half of the width of an edge of one pixel, in heights.
        let edge = 0.8 / cell_px;
        let waterline = (1.0 + edge) + (-edge - (1.0 + edge)) * tone;
        ((height - waterline) / (2.0 * edge) + 0.5).clamp(0.0, 1.0)
    }
}
