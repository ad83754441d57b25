//! From surface colours to the bytes of the picture: the image effects, and the one rounding.

use glam::DVec4;
use rayon::prelude::*;

use super::{steps::Nudge, surface::surfaces};
use crate::{
    effects::{
        Stack,
        dots::{Dots, FULL},
        hooks::{Picture, Pixel, tone::encoded},
    },
    frame::Geometry,
    math::srgb_byte,
    scene::{Scene, draw::Draw, view::View},
};

/// The integers that a picture is coloured from, row-major.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Global triangle id per pixel, [`crate::frame::NO_TRIANGLE`] without one.
    pub triangle_ids: &'a [u32],
    /// Depth key per pixel, 0 without an triangle id.
    pub keys: &'a [u32],
    /// Strength of the strongest dot per pixel; empty without dots.
    pub dots: &'a [u32],
    /// The picture before this one; none for the first.
    pub previous: Option<&'a [[u8; 4]]>,
}

/// Bytes of all pixels, given who owns them. Row-major, gamma-encoded.
pub fn shade(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack, seen: &Seen, geometry: &Geometry) -> Vec<[u8; 4]> {
    shade_nudged(scene, draws, view, stack, seen, geometry, Nudge::default())
}

/// The same, with every step of colour moved by `nudge`, and textures looked up aside.
pub(super) fn shade_nudged(
    scene: &Scene,
    draws: &[Draw],
    view: &View,
    stack: &Stack,
    seen: &Seen,
    geometry: &Geometry,
    nudge: Nudge,
) -> Vec<[u8; 4]> {
    let background = background(view);
    let colors = surfaces(scene, draws, view, stack, (seen.triangle_ids, background), geometry, nudge);
    finish_all(draws, view, stack, seen, &colors, nudge.step)
}

/// Bytes of a picture from its gamma-encoded colours, through the image effects, with every step moved by `nudge`.
pub(super) fn finish_all(draws: &[Draw], view: &View, stack: &Stack, seen: &Seen, colors: &[DVec4], nudge: f64) -> Vec<[u8; 4]> {
    let first: Vec<u32> = draws.iter().map(|draw| draw.first_triangle).collect();
    let picture = Picture {
        width: view.width,
        height: view.height,
        triangle_ids: seen.triangle_ids,
        keys: seen.keys,
        draws: &first,
        previous: seen.previous,
        background: background(view),
    };
    let dots = stack.dots().filter(|_| !seen.dots.is_empty());
    let finished = |(i, &color): (usize, &DVec4)| {
        let color = dots.as_ref().map_or(color, |dots| dotted(dots, color, picture.background, seen.dots[i]));
        let pixel = Pixel { color, x: i as u32 % view.width, y: i as u32 / view.width, nudge };
        bytes(if stack.finishes() { stack.finish(pixel, &picture).color } else { color })
    };
    colors.par_iter().enumerate().map(finished).collect()
}

/// A pixel with a dot of some strength over its surface, or over the background alone.
fn dotted(dots: &Dots, color: DVec4, background: DVec4, strength: u32) -> DVec4 {
    let beneath = if dots.model != 0 { color } else { background };
    let share = f64::from(strength) / f64::from(FULL) * f64::from(dots.color[3]);
    beneath + (encoded(dots.color).truncate().extend(1.0) - beneath) * share
}

/// The background, gamma-encoded and rounded as a picture holds it.
pub(super) fn background(view: &View) -> DVec4 {
    let [r, g, b, alpha] = view.background.map(f64::from);
    let [r, g, b] = [r, g, b].map(|c| f64::from(srgb_byte(c)) / 255.0);
    DVec4::new(r, g, b, alpha.clamp(0.0, 1.0))
}

/// Rounds to bytes, halves away from zero.
pub(super) fn bytes(color: DVec4) -> [u8; 4] {
    color.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0) + 0.5).floor() as u8)
}
