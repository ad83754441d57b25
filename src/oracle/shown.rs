//! Scaled pictures: drawn with more or fewer pixels than are shown, and brought to their size in f64; and what they are
//! measured against.

use glam::{DMat4, DVec4};
use rayon::prelude::*;

use super::{finest, project_moved, render, render_sequence, traced};
use crate::{
    effects::Stack,
    frame::Frame,
    math::{linear_light, srgb_byte},
    measure::References,
    scene::{
        Scene,
        draw::{DrawError, draws},
        view::View,
    },
};

/// The true picture of the last of `moments`, drawn with `factor` times as many pixels to a side and shown at the size that
/// its view says.
///
/// # Errors
/// As [`render`].
///
/// # Panics
/// Without a moment.
pub fn render_scaled(scene: &Scene, moments: &[(View, Stack)], factor: f64) -> Result<Frame, DrawError> {
    let (view, _) = moments.last().expect("a picture shows a moment");
    if factor == 1.0 || view.pixels() == 0 {
        return render_sequence(scene, moments);
    }
    let drawn: Vec<_> = moments.iter().map(|(view, stack)| (view.scaled(factor), stack.scaled(factor))).collect();
    let frame = render_sequence(scene, &drawn)?;
    let size = [view.width, view.height];
    Ok(frame.shown(size, scaled(&frame.color, [frame.width, frame.height], size)))
}

/// A picture of one size brought to another, in linear light: the mean of whole squares of pixels where it shrinks by whole
/// factors, else between the four nearest.
pub fn scaled(color: &[[u8; 4]], from: [u32; 2], to: [u32; 2]) -> Vec<[u8; 4]> {
    let light: Vec<f64> = (0..=255u8).map(|byte| linear_light(f64::from(byte) / 255.0)).collect();
    let side = from[0] / to[0].max(1);
    let is_whole = side > 1 && [0, 1].iter().all(|&axis| from[axis] == side * to[axis]);
    let pixel = |x: u32, y: u32| {
        let mut sum = Light::default();
        let mut add = |x: u32, y: u32, weight: f64| sum.add(&color[(y * from[0] + x) as usize], weight, &light);
        if is_whole {
            let weight = 1.0 / f64::from(side * side);
            (0..side * side).for_each(|i| add(x * side + i % side, y * side + i / side, weight));
        } else {
            let place = |at: u32, axis: usize| {
                let at = (f64::from(at) + 0.5) * f64::from(from[axis]) / f64::from(to[axis]) - 0.5;
                let held = |at: f64| at.clamp(0.0, f64::from(from[axis] - 1)) as u32;
                let share = at - at.floor();
                [(held(at.floor()), 1.0 - share), (held(at.floor() + 1.0), share)]
            };
            let columns = place(x, 0);
            for (y, by_row) in place(y, 1) {
                columns.iter().for_each(|&(x, by_column)| add(x, y, by_row * by_column));
            }
        }
        sum.bytes()
    };
    (0..to[1]).into_par_iter().flat_map_iter(|y| (0..to[0]).map(move |x| (x, y)).map(|(x, y)| pixel(x, y)).collect::<Vec<_>>()).collect()
}

/// Light of several pixels, each as far as it is opaque.
#[derive(Clone, Copy, Default)]
struct Light {
    opaque: [f64; 3],
    plain: [f64; 3],
    alpha: f64,
}

impl Light {
    fn add(&mut self, bytes: &[u8; 4], weight: f64, light: &[f64]) {
        let alpha = weight * f64::from(bytes[3]) / 255.0;
        self.alpha += alpha;
        for (channel, &byte) in bytes[..3].iter().enumerate() {
            self.opaque[channel] += alpha * light[usize::from(byte)];
            self.plain[channel] += weight * light[usize::from(byte)];
        }
    }

    fn bytes(&self) -> [u8; 4] {
        let [r, g, b] = if self.alpha > 0.0 { self.opaque.map(|v| v / self.alpha) } else { self.plain };
        [srgb_byte(r), srgb_byte(g), srgb_byte(b), (self.alpha.min(1.0) * 255.0 + 0.5) as u8]
    }
}

/// What options are measured against: the true picture and its corners at every size that is drawn, `factors` times as many
/// pixels to a side, on the finest grid; and where sizes are compared, the true picture of eight by eight samples a pixel.
///
/// # Errors
/// As [`render`].
pub fn references(scene: &Scene, view: &View, stack: &Stack, factors: &[f64]) -> Result<References, DrawError> {
    let view = &traced(view, stack);
    let at = |&factor: &f64| {
        let (view, stack) = (view.scaled(factor), stack.scaled(factor));
        let fine = finest(&view, &stack);
        Ok((factor, render(scene, &fine, &stack)?, project_moved(scene, &draws(scene, &fine)?, &fine, &stack)))
    };
    let pictures = factors.iter().map(at).collect::<Result<Vec<_>, DrawError>>()?;
    let smooth = if factors.len() > 1 { Some(smooth(scene, view, stack)?) } else { None };
    Ok(References { pictures, smooth })
}

/// Samples to a side of a pixel.
const SAMPLES: u32 = 8;

/// The mean of 64 pictures, each moved by its share of a pixel: eight by eight samples a pixel, with effects on the picture
/// as large as they are in one.
fn smooth(scene: &Scene, view: &View, stack: &Stack) -> Result<Vec<[u8; 4]>, DrawError> {
    let light: Vec<f64> = (0..=255u8).map(|byte| linear_light(f64::from(byte) / 255.0)).collect();
    let mut sums = vec![Light::default(); view.pixels()];
    for sample in 0..SAMPLES * SAMPLES {
        let [x, y] = [sample % SAMPLES, sample / SAMPLES].map(|i| 0.5 - (f64::from(i) + 0.5) / f64::from(SAMPLES));
        // Pixels to the right and down, as normalized coordinates have them.
        let aside = DVec4::new(2.0 * x / f64::from(view.width), -2.0 * y / f64::from(view.height), 0.0, 1.0);
        let moved = DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::Z, aside);
        let frame = render(scene, &finest(&View { clip_from_world: moved * view.clip_from_world, ..view.clone() }, stack), stack)?;
        let weight = 1.0 / f64::from(SAMPLES * SAMPLES);
        sums.par_iter_mut().zip(&frame.color).for_each(|(sum, color)| sum.add(color, weight, &light));
    }
    Ok(sums.iter().map(Light::bytes).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_picture_stays_what_it_is_and_a_mean_is_one_of_light() {
        let even = vec![[10, 200, 77, 255]; 12];
        assert_eq!(scaled(&even, [4, 3], [9, 2]), vec![[10, 200, 77, 255]; 18]);
        let halves = vec![[0, 0, 0, 255], [255, 255, 255, 255], [0, 0, 0, 255], [255, 255, 255, 255]];
        // Half of the light is encoded as 188, not as 128.
        assert_eq!(scaled(&halves, [2, 2], [1, 1]), [[188, 188, 188, 255]]);
    }

    #[test]
    fn what_is_transparent_adds_no_colour() {
        let edge = vec![[255, 0, 0, 255], [0, 255, 0, 0], [255, 0, 0, 255], [0, 255, 0, 0]];
        assert_eq!(scaled(&edge, [2, 2], [1, 1]), [[255, 0, 0, 128]]);
        assert_eq!(scaled(&[[9, 8, 7, 0]; 4], [2, 2], [1, 1]), [[9, 8, 7, 0]]);
    }

    #[test]
    fn between_two_pixels_light_changes_evenly() {
        let [a, b] = [[0, 0, 0, 255], [255, 255, 255, 255]];
        let wide = scaled(&[a, b], [2, 1], [8, 1]);
        let light: Vec<f64> = wide.iter().map(|pixel| linear_light(f64::from(pixel[0]) / 255.0)).collect();
        assert_eq!((wide[0], wide[7]), (a, b));
        assert!(light.windows(2).all(|pair| (0.0..0.26).contains(&(pair[1] - pair[0]))), "{light:?}");
    }
}
