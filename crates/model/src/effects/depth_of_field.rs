//! Depth of field: what is not at the distance in focus spreads to discs of light.

use glam::{DVec2, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect, tone::turned},
};
use crate::{choice, params};

choice! {
    /// What is in focus.
    pub enum Focus {
        /// What is seen at a place of the picture, or nearest to it where nothing is.
        Place = "place",
        /// A distance.
        Distance = "distance",
    }
}

params! {
    pub struct DepthOfField {
        /// What is in focus.
        focus: Focus = Focus::Place as u32;
        /// The place in focus, from the left edge at 0 to the right one at 1.
        focus_x: f32 = 0.5, hard 0.0..=1.0, when ("focus", &["place"]);
        /// The same from the top to the bottom.
        focus_y: f32 = 0.5, hard 0.0..=1.0, when ("focus", &["place"]);
        /// Distance in focus, along the viewing direction.
        focus_m: f32 = 6.0, hard 0.001..=1000000.0, soft 0.1..=100.0, log true, unit "m", when ("focus", &["distance"]);
        /// Radius of the disc to which a point infinitely far away spreads.
        aperture_px: f32 = 16.0, hard 0.0..=1024.0, soft 0.0..=64.0, unit "px";
        /// The largest such radius.
        most_px: f32 = 10.0, hard 1.0..=96.0, soft 1.0..=32.0, unit "px";
        /// How much more bright points weigh than dark ones.
        highlights: f32 = 3.0, hard 0.0..=64.0, soft 0.0..=16.0;
    }
}

/// Reads around a pixel.
const TAPS: i32 = 96;

/// Rings about the place in focus on which a surface is looked for, up to the picture's height.
const RINGS: i64 = 16;

/// The places of a ring, to the right and down.
const COMPASS: [[i64; 2]; 8] = [
    [1, 0],
    [0, 1],
    [-1, 0],
    [0, -1],
    [1, 1],
    [-1, 1],
    [-1, -1],
    [1, -1],
];

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<DepthOfField>(
        "depth_of_field",
        "DepthOfField",
        "what is out of focus spreads to discs of light",
    )
    .on_passes::<DepthOfField>()
    .into()
});

impl PassEffect for DepthOfField {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let here_m = at.depth_m(at.x, at.y);
        let focus_m = p.focus_m(at);
        let here_px = p.radius(here_m, focus_m);
        let (mut sum, mut weights) = (at.color(at.x, at.y), 1.0);
        for i in 0..TAPS {
            // A spiral that fills a disc evenly.
            let turns = f64::from(i) * 0.618_033_988_749_894_9;
            let fraction = (f64::from(i) + 0.5) / f64::from(TAPS);
            let away = f64::from(p.most_px) * fraction.sqrt();
            let step = away * turned(360.0 * turns);
            let step = [step.x, step.y].map(|by| by.round_ties_even() as i64);
            let there_m = at.depth_m(at.x + step[0], at.y + step[1]);
            let mut there_px = p.radius(there_m, focus_m);
            // Light from behind does not spread over what is sharp before it.
            if there_m > here_m {
                there_px = there_px.min(here_px);
            }
            let color = at.color(at.x + step[0], at.y + step[1]);
            let brightest = color.truncate().max_element().clamp(0.0, 1.0);
            let distance = ((step[0] * step[0] + step[1] * step[1]) as f64).sqrt();
            let weight = (there_px - distance + 1.0).clamp(0.0, 1.0)
                * (1.0 + f64::from(p.highlights) * brightest * brightest);
            sum += weight * color;
            weights += weight;
        }
        sum / weights
    }
}

impl DepthOfField {
    /// The distance in focus. A little is added, so that a number that is about whole falls on its
    /// pixel everywhere.
    fn focus_m(&self, at: &ImageAt) -> f64 {
        if Focus::of(self.focus) == Focus::Distance {
            return self.focus_m.into();
        }
        let size = at.picture_size();
        let place = DVec2::new(self.focus_x.into(), self.focus_y.into());
        let place = (place * size + 0.003_906_25).floor();
        let [x, y] = [place.x as i64, place.y as i64];
        let is_drawn = |[x, y]: &[i64; 2]| at.input.picture.at(*x, *y).1 != 0;
        let [x, y] = std::iter::once([x, y])
            .chain((1..=RINGS).flat_map(|ring| {
                let away = size.y as i64 * ring / RINGS;
                COMPASS.map(|[right, down]| [x + away * right, y + away * down])
            }))
            .find(is_drawn)
            .unwrap_or([x, y]);
        at.depth_m(x, y)
    }

    /// Radius of the disc to which a point so far away spreads, pixels.
    fn radius(&self, depth_m: f64, focus_m: f64) -> f64 {
        let spread = f64::from(self.aperture_px) * (1.0 - focus_m / depth_m).abs();
        spread.min(f64::from(self.most_px))
    }
}
