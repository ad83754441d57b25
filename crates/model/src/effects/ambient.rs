//! Ambient: corners and folds darken where little of the sky reaches them.
//!
//! Seen from the picture alone: a pixel is darker the more of what lies around it stands out from
//! the plane on which it lies, as far as the depths of its neighbors tell.

use glam::{DVec2, DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{
        ImageAt, PassEffect,
        tone::{rgb, turned},
    },
};
use crate::{
    math::{hash, hash_unit},
    words,
};

words! {
    pub struct Ambient of "ambient" {
        shade: [f32; 4],
        radius_m: f32,
        strength: f32,
        most_px: f32,
        soft_px: u32,
    }
}

/// Reads around a pixel.
const TAPS: i32 = 20;

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Ambient>()
    .on_passes::<Ambient>()
    .into()
});

impl PassEffect for Ambient {
    fn pass(index: usize, at: &ImageAt, p: &Self) -> DVec4 {
        match index {
            0 => p.find(at),
            1 => p.mean(at, [1, 0]),
            _ => {
                let color = at.color(at.x, at.y);
                let strength = f64::from(p.strength) * f64::from(p.shade[3]);
                let hidden = (strength * p.mean(at, [0, 1]).x).clamp(0.0, 1.0);
                let kept = DVec3::ONE + (rgb(p.shade) - 1.0) * hidden;
                (color.truncate() * kept).extend(color.w)
            }
        }
    }
}

impl Ambient {
    /// How much is hidden from a pixel, in red, and its reversed depth, in alpha.
    fn find(&self, at: &ImageAt) -> DVec4 {
        let (triangle_id, key, _) = at.input.picture.at(at.x, at.y);
        let here_m = at.depth_m(at.x, at.y);
        if triangle_id.is_none() {
            return DVec4::ZERO;
        }
        let depth = f64::from(f32::from_bits(key));
        // On a plane, depths change evenly across the picture.
        let slope = [[1, 0], [0, 1]].map(|step| slope(at, depth, step));
        let radius_m = self.radius_m(at, here_m);
        let reach_px =
            (radius_m / at.input.lens.pixel_size_m(here_m)).clamp(1.0, f64::from(self.most_px));
        let first = hash_unit(hash(at.x as u32).wrapping_add(at.y as u32));
        let mut hidden = 0.0;
        for i in 0..TAPS {
            let turns = first + f64::from(i) * 0.618_033_988_749_894_9;
            let away = reach_px * (f64::from(i) + 0.5) / f64::from(TAPS);
            let step = away * turned(360.0 * turns) + DVec2::splat(0.5 + at.step_offset);
            let step = [step.x, step.y].map(|by| by.floor() as i64);
            let plane = depth + slope[0] * step[0] as f64 + slope[1] * step[1] as f64;
            let (_, key, _) = at.input.picture.at(at.x + step[0], at.y + step[1]);
            let seen = f64::from(f32::from_bits(key));
            // How far what is seen there stands out from the plane of this pixel.
            let height = at.meters_apart(seen, plane - seen) / radius_m;
            hidden += (4.0 * height - 0.1).clamp(0.0, 1.0) * (2.0 - height).clamp(0.0, 1.0);
        }
        DVec4::new(hidden / f64::from(TAPS), 0.0, 0.0, depth)
    }

    /// Mean along a direction of pixels at about the same depth.
    fn mean(&self, at: &ImageAt, along: [i64; 2]) -> DVec4 {
        let here = at.last(at.x, at.y);
        let radius_m = self.radius_m(at, at.input.lens.meters(here.w));
        let (mut sum, mut weights) = (0.0, 0.0);
        let reach = i64::from(self.soft_px);
        for i in -reach..=reach {
            let there = at.last(at.x + i * along[0], at.y + i * along[1]);
            let apart = at.meters_apart(here.w, there.w - here.w) / radius_m;
            let weight = 1.0 / (1.0 + 16.0 * apart * apart);
            sum += weight * there.x;
            weights += weight;
        }
        DVec4::new(sum / weights, 0.0, 0.0, here.w)
    }

    /// No less than a pixel is, whose depth tells nothing smaller.
    fn radius_m(&self, at: &ImageAt, here_m: f64) -> f64 {
        f64::from(self.radius_m).max(at.input.lens.pixel_size_m(here_m))
    }
}

/// The smaller of the changes of depth to both sides.
fn slope(at: &ImageAt, depth: f64, [right, down]: [i64; 2]) -> f64 {
    let of = |x: i64, y: i64| f64::from(f32::from_bits(at.input.picture.at(x, y).1));
    let ahead = of(at.x + right, at.y + down) - depth;
    let behind = depth - of(at.x - right, at.y - down);
    if ahead.abs() < behind.abs() {
        ahead
    } else {
        behind
    }
}
