//! Depth of field: what is not at the distance in focus spreads to discs of light.

use glam::{DVec2, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect, tone::turned},
};
use crate::{choice, math::HASH_GOLDEN, words};

choice! {
    /// What is in focus.
    pub enum Focus {
        /// What is seen at a place of the picture, or nearest to it where nothing is.
        Place,
        /// A distance.
        Distance,
    }
}

words! {
    pub struct DepthOfField of "depth_of_field" {
        focus: u32,
        focus_x: f32,
        focus_y: f32,
        focus_m: f32,
        aperture_px: f32,
        most_px: f32,
        highlights: f32,
    }
}

/// Reads around a pixel.
const TAPS: u32 = 96;
/// Steps to a unit of the spiral: none of its coordinates lies near half a step, so that they are
/// the same everywhere.
const UNIT: i64 = 1536;

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
    Effect::declared::<DepthOfField>()
    .on_passes::<DepthOfField>()
    .into()
});

impl PassEffect for DepthOfField {
    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let here_m = at.depth_m(at.x, at.y);
        let focus_m = p.focus_m(at);
        let here_px = p.radius(here_m, focus_m);
        let most = (f64::from(p.most_px) * 256.0).round_ties_even() as i64;
        let (mut sum, mut weights) = (at.color(at.x, at.y), 1.0);
        for i in 0..TAPS {
            // To the nearest pixel, in integers.
            let step = [spiral(i).x, spiral(i).y].map(|unit| {
                let step = most * unit.round_ties_even() as i64;
                (step + 128 * UNIT).div_euclid(256 * UNIT)
            });
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

/// A point of a spiral that fills a disc of the radius `UNIT` evenly.
fn spiral(i: u32) -> DVec2 {
    let turns = f64::from(i.wrapping_mul(HASH_GOLDEN) >> 8) / f64::from(1 << 24);
    let fraction = (f64::from(i) + 0.5) / f64::from(TAPS);
    UNIT as f64 * fraction.sqrt() * turned(360.0 * turns)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn f32_rounds_every_point_of_the_spiral_as_f64_does() {
        for at in (0..TAPS).flat_map(|i| spiral(i).to_array()) {
            assert!((at.rem_euclid(1.0) - 0.5).abs() > 0.01, "{at}");
        }
    }
}
