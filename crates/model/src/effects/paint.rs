//! Paint: brush strokes that follow the shapes of the picture (anisotropic Kuwahara filter).
//!
//! After Kyprianidis, Semmo, Kang and Döllner 2010: the directions in which the picture changes are
//! smoothed, an ellipse along them is divided into eight sectors, and those with the least variance
//! give their mean color.

use glam::{DVec2, DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect},
};
use crate::words;

words! {
    pub struct Paint of "paint" {
        radius_px: f32,
        stretch: f32,
        smooth_px: f32,
        hardness: f32,
        saturation: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Paint>()
        .on_passes::<Paint>()
        .into()
});

impl PassEffect for Paint {
    fn pass(index: usize, at: &ImageAt, p: &Self) -> DVec4 {
        match index {
            0 => tensor(at),
            1 => mean_along(at, [1, 0], f64::from(p.smooth_px)),
            2 => mean_along(at, [0, 1], f64::from(p.smooth_px)),
            _ => p.stroke(at),
        }
    }
}

/// How the picture changes across and down: squares and product, as the eye sees it.
fn tensor(at: &ImageAt) -> DVec4 {
    let (mut across, mut down) = (DVec3::ZERO, DVec3::ZERO);
    for i in -1..=1_i64 {
        let weight = (2 - i.abs()) as f64;
        across += weight * (tone(at, at.x + 1, at.y + i) - tone(at, at.x - 1, at.y + i));
        down += weight * (tone(at, at.x + i, at.y + 1) - tone(at, at.x + i, at.y - 1));
    }
    DVec4::new(across.dot(across), across.dot(down), down.dot(down), 1.0)
}

impl Paint {
    /// Of eight sectors around a pixel, stretched along the shape that it lies on, the calmest give
    /// their color.
    fn stroke(&self, at: &ImageAt) -> DVec4 {
        let tensor = at.last(at.x, at.y);
        let (difference, trace) = (tensor.x - tensor.z, tensor.x + tensor.z);
        let root = (difference * difference + 4.0 * tensor.y * tensor.y).sqrt();
        // Along the shape: the direction of least change.
        let along = if difference < 0.0 {
            DVec2::new(root - difference, -2.0 * tensor.y)
        } else {
            DVec2::new(-2.0 * tensor.y, root + difference)
        };
        let size = along.length();
        let calm = if size > 1e-9 {
            along / size.max(1e-12)
        } else {
            DVec2::X
        };
        let narrow = 1.0 + f64::from(self.stretch) * root / (trace + 0.002);
        let radius = f64::from(self.radius_px);
        let (long, wide) = (radius * narrow, radius / narrow);
        let crossed = DVec2::new(calm.y, calm.x);
        let reach = (calm * calm * long * long + crossed * crossed * wide * wide).map(f64::sqrt);
        let reach = [reach.x, reach.y].map(|side| side.ceil() as i64);

        let (mut means, mut squares) = ([DVec4::ZERO; 8], [DVec3::ZERO; 8]);
        let middle = tone(at, at.x, at.y);
        for j in -reach[1]..=reach[1] {
            for i in -reach[0]..=reach[0] {
                let step = DVec2::new(i as f64, j as f64);
                let side = DVec2::new(-calm.y, calm.x);
                let v = DVec2::new(step.dot(calm) / long, step.dot(side) / wide);
                let near = 1.0 - v.length_squared();
                if near <= 0.0 {
                    continue;
                }
                let tone = tone(at, at.x + i, at.y + j) - middle;
                let diagonal = std::f64::consts::FRAC_1_SQRT_2 * DVec2::new(v.x - v.y, v.x + v.y);
                let (straight, slanted) = (sectors(v), sectors(diagonal));
                for k in 0..8 {
                    let shape = if k & 1 == 1 { slanted } else { straight }[k / 2];
                    let weight = near * near * shape * shape;
                    means[k] += (tone * weight).extend(weight);
                    squares[k] += tone * tone * weight;
                }
            }
        }
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        for (of_sector, square) in means.into_iter().zip(squares) {
            let share = of_sector.w.max(1e-9);
            let mean = of_sector.truncate() / share;
            let spread = (square / share - mean * mean).max(DVec3::ZERO);
            let rough = f64::from(self.hardness) * spread.element_sum();
            let weight = 1.0 / (1.0 + rough * rough);
            sum += weight * mean;
            weights += weight;
        }
        let tone = (middle + sum / weights).max(DVec3::ZERO);
        let gray = tone.element_sum() / 3.0;
        let vivid = (gray + f64::from(self.saturation) * (tone - gray)).max(DVec3::ZERO);
        (vivid * vivid).extend(at.color(at.x, at.y).w)
    }
}

/// How far a place belongs to the sectors on the right, below, on the left and above; of all, the
/// neighbors overlap.
fn sectors(v: DVec2) -> [f64; 4] {
    let (across, down) = (0.25 - 0.6 * v.y * v.y, 0.25 - 0.6 * v.x * v.x);
    [v.x + across, v.y + down, -v.x + across, -v.y + down].map(|part| part.max(0.0))
}

/// Square roots are about what the eye sees.
fn tone(at: &ImageAt, x: i64, y: i64) -> DVec3 {
    at.color(x, y).truncate().max(DVec3::ZERO).map(f64::sqrt)
}

fn mean_along(at: &ImageAt, along: [i64; 2], radius: f64) -> DVec4 {
    let reach = radius.ceil() as i64;
    let (mut sum, mut weights) = (DVec4::ZERO, 0.0);
    for i in -reach..=reach {
        let t = i as f64 / (radius + 1.0);
        let weight = (1.0 - t * t).max(0.0);
        sum += weight * at.last(at.x + i * along[0], at.y + i * along[1]);
        weights += weight;
    }
    sum / weights
}
