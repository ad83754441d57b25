//! Resolve: from surface colors to the bytes of the picture. Dots, image effects, and the one
//! rounding.

use std::ops::Range;

use glam::DVec4;
use rayon::prelude::*;

use super::{
    super::{perturbation::Perturbation, shot::Shot},
    shading::{TOGETHER, surface_colors},
};
use crate::{
    effects::{
        Stack,
        dots::{Dots, FULL},
        hooks::{Picture, Pixel, tone::encoded},
    },
    frame::Geometry,
    work::{Canceled, map_each},
};

/// The images that a picture is colored from, row-major.
#[derive(Clone, Copy, Debug)]
pub struct ResolveInput<'a> {
    /// Global triangle id per pixel, [`NO_TRIANGLE`](crate::frame::NO_TRIANGLE) without one.
    pub triangle_ids: &'a [u32],
    /// Depth key per pixel, 0 without a triangle.
    pub depth_keys: &'a [u32],
    /// Strength of the strongest dot per pixel; empty without dots.
    pub dots: &'a [u32],
    /// The previous picture; none for the first.
    pub previous: Option<&'a [[u8; 4]]>,
}

/// A color that is this close to the middle between two bytes, 1/1024 of a step, may be either in
/// f32.
pub const TIE: f64 = 1.0 / (255.0 * 1024.0);

/// Bytes of all pixels, row-major, gamma-encoded.
pub fn shade(
    shot: &Shot,
    input: &ResolveInput,
    geometry: &Geometry,
) -> Result<Vec<[u8; 4]>, Canceled> {
    shade_rows(shot, input, geometry, 0..shot.view.height)
}

/// The same, only of the pixels in `rows`.
pub fn shade_rows(
    shot: &Shot,
    input: &ResolveInput,
    geometry: &Geometry,
    rows: Range<u32>,
) -> Result<Vec<[u8; 4]>, Canceled> {
    let steady = Perturbation::default();
    let colors = surface_colors(shot, input.triangle_ids, geometry, &steady, rows.clone())?;
    let first = (rows.start * shot.view.width) as usize;
    let rounded = |colors: Vec<DVec4>| colors.into_iter().map(bytes).collect();
    finished_each(shot, input, (first, &colors), 0.0, rounded)
}

/// Bytes of all pixels under a perturbation.
pub fn shade_perturbed(
    shot: &Shot,
    input: &ResolveInput,
    geometry: &Geometry,
    perturbation: &Perturbation,
) -> Result<Vec<[u8; 4]>, Canceled> {
    let rows = 0..shot.view.height;
    let colors = surface_colors(shot, input.triangle_ids, geometry, perturbation, rows)?;
    finish(shot, input, &colors, perturbation.color_step)
}

/// Bytes of a picture from its gamma-encoded surface colors: dots and image effects, whose steps
/// are moved by `color_step`.
pub fn finish(
    shot: &Shot,
    input: &ResolveInput,
    colors: &[DVec4],
    color_step: f64,
) -> Result<Vec<[u8; 4]>, Canceled> {
    let rounded = |colors: Vec<DVec4>| colors.into_iter().map(bytes).collect();
    finished_each(shot, input, (0, colors), color_step, rounded)
}

/// The same with both bytes of each channel whose color lies in the middle between two: all lower
/// ones, and all upper ones.
pub fn finish_at_ties(
    shot: &Shot,
    input: &ResolveInput,
    colors: &[DVec4],
    color_step: f64,
) -> Result<[Vec<[u8; 4]>; 2], Canceled> {
    let both = |colors: Vec<DVec4>| colors.into_iter().map(at_ties).collect();
    Ok(finished_each(shot, input, (0, colors), color_step, both)?
        .into_iter()
        .map(|[lower, upper]| (lower, upper))
        .unzip::<_, _, Vec<_>, Vec<_>>()
        .into())
}

/// What `rounded` makes of the finished colors, given those of the surfaces and the index of the
/// first pixel.
fn finished_each<T: Send>(
    shot: &Shot,
    input: &ResolveInput,
    (first, colors): (usize, &[DVec4]),
    color_step: f64,
    rounded: impl Fn(Vec<DVec4>) -> Vec<T> + Sync,
) -> Result<Vec<T>, Canceled> {
    let tables = PictureTables::of(shot);
    let finish = Finish::new(shot, input, &tables);
    let parts = map_each(
        colors.par_chunks(TOGETHER).enumerate(),
        |(part, colors): (usize, &[DVec4])| {
            let pixels = (first + part * TOGETHER..).zip(colors);
            rounded(finish.colors(pixels.map(|(i, &color)| (i, color, color_step))))
        },
    )?;
    Ok(parts.into_iter().flatten().collect())
}

/// What image effects read beside the images.
pub struct PictureTables {
    /// First triangle of every draw.
    pub(super) draws: Vec<u32>,
    /// The background of every row.
    pub(super) background: Vec<[u8; 4]>,
}

impl PictureTables {
    pub fn of(shot: &Shot) -> Self {
        let draws = shot.draws.iter().map(|draw| draw.first_triangle).collect();
        Self {
            draws,
            background: shot.view.background.rows(shot.view.height),
        }
    }
}

/// Dots and image effects, pixel by pixel.
pub struct Finish<'a> {
    stack: &'a Stack,
    dots: Option<Dots>,
    strengths: &'a [u32],
    picture: Picture<'a>,
}

impl<'a> Finish<'a> {
    /// Over the images of `input`.
    pub fn new(shot: &Shot<'a>, input: &ResolveInput<'a>, tables: &'a PictureTables) -> Self {
        let picture = tables.picture(shot, input);
        let dots = shot.stack.dots().filter(|_| !input.dots.is_empty());
        Self {
            stack: shot.stack,
            dots,
            strengths: input.dots,
            picture,
        }
    }

    /// The colors of pixels before they are rounded, given the index, the gamma-encoded surface
    /// color and the offset of steps of each.
    pub fn colors(&self, pixels: impl Iterator<Item = (usize, DVec4, f64)>) -> Vec<DVec4> {
        let dotted = |(i, color, step_offset): (usize, DVec4, f64)| {
            let (x, y) = (i as u32 % self.picture.width, i as u32 / self.picture.width);
            let color = self.dots.as_ref().map_or(color, |dots| {
                dotted(dots, color, self.picture.background(y), self.strengths[i])
            });
            Pixel {
                color,
                x,
                y,
                step_offset,
            }
        };
        let mut pixels: Vec<Pixel> = pixels.map(dotted).collect();
        self.stack.finish_all(&mut pixels, &self.picture);
        pixels.into_iter().map(|pixel| pixel.color).collect()
    }
}

/// Both bytes of each channel whose color lies in the middle between two.
pub fn at_ties(color: DVec4) -> [[u8; 4]; 2] {
    [-TIE, TIE].map(|offset| bytes(color + offset))
}

/// A pixel with a dot over its surface, or over the background if the effect hides the model.
fn dotted(dots: &Dots, color: DVec4, background: DVec4, strength: u32) -> DVec4 {
    let beneath = if dots.show_model != 0 {
        color
    } else {
        background
    };
    let opacity = f64::from(strength) / f64::from(FULL) * f64::from(dots.color[3]);
    beneath + (encoded(dots.color).truncate().extend(1.0) - beneath) * opacity
}

/// Rounds to bytes, halves away from zero.
pub fn bytes(color: DVec4) -> [u8; 4] {
    color
        .to_array()
        .map(|c| (255.0 * c.clamp(0.0, 1.0) + 0.5).floor() as u8)
}
