//! Palette: every pixel takes the nearest of a few inks, mixed by ordered dithering.
//!
//! The distance of colors is that of Yliluoma's dithering for few colors: channels weighted by how
//! bright they look, and brightness once more. It is a quadratic form of gamma-encoded values, so
//! which of two inks is nearer depends on a color linearly, and an error of the color by as much.

use glam::{DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect, tone::bayer_rank},
};
use crate::{
    choice,
    math::{linear_light, srgb},
    params,
};

choice! {
    /// The inks.
    pub enum Inks {
        /// Four greens of a handheld screen.
        Handheld = "handheld",
        /// Black, cyan, magenta, white.
        Cga = "cga",
        /// Eight from night over embers to white.
        Ember = "ember",
        /// Sixteen for everything.
        Arcade = "arcade",
    }
}

params! {
    pub struct Palette {
        /// The inks.
        inks: Inks = Inks::Arcade as u32;
        /// How far a 4 by 4 matrix moves colors apart before each takes its ink, of black to white.
        dither: f32 = 0.12, hard 0.0..=1.0;
        /// Side of a cell of the matrix.
        cell_px: u32 = 1, hard 1.0..=1024.0, soft 1.0..=8.0, unit "px";
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Palette>(
        "palette",
        "Palette",
        "every pixel takes the nearest of a few inks, dithered",
    )
    .on_passes::<Palette>()
    .into()
});

/// The inks of every list, gamma-encoded, `0xRRGGBB`.
const HANDHELD: [u32; 4] = [0x000f_380f, 0x0030_6230, 0x008b_ac0f, 0x009b_bc0f];
const CGA: [u32; 4] = [0x0000_0000, 0x0055_ffff, 0x00ff_55ff, 0x00ff_ffff];
const EMBER: [u32; 8] = [0x000d_0b14, 0x003b_1530, 0x007a_1f3d, 0x00bf_3b34, 0x00e8_743b, 0x00f6_b25a, 0x00fb_e3a0, 0x00ff_fbea];
const ARCADE: [u32; 16] = [0x0016_131f, 0x003a_2e4f, 0x006e_4463, 0x00b0_435a, 0x00e0_704a, 0x00f2_b25e, 0x00f7_e3a1, 0x00fb_f7ef, 0x009a_a7b5, 0x005c_6b80, 0x002b_4a6f, 0x003f_8fc0, 0x008f_d6d8, 0x002f_6b4f, 0x006f_ae5a, 0x00a0_694b];

/// Two inks whose squared distances differ by no more than so many times the offset of a step are
/// both right: a color that errs by some of them moves that difference by 3.5 times as much.
const BAND: f64 = 4.0;

impl Inks {
    const fn colors(self) -> &'static [u32] {
        match self {
            Self::Handheld => &HANDHELD,
            Self::Cga => &CGA,
            Self::Ember => &EMBER,
            Self::Arcade => &ARCADE,
        }
    }
}

impl PassEffect for Palette {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let color = at.color(at.x, at.y);
        let [x, y] = [at.x, at.y].map(|place| place as u32 / p.cell_px);
        let threshold = (f64::from(bayer_rank(x, y, 2)) + 0.5) / 16.0 - 0.5;
        let wanted =
            color.truncate().map(srgb) + DVec3::splat(threshold * f64::from(p.dither));
        let inks: Vec<DVec3> = Inks::of(p.inks).colors().iter().map(|ink| encoded(*ink)).collect();
        let nearest = inks[nearest(wanted, &inks, at.step_offset)];
        nearest.map(linear_light).extend(color.w)
    }
}

/// Gamma-encoded red, green and blue of `0xRRGGBB`, each 0 to 1.
fn encoded(ink: u32) -> DVec3 {
    let [_, r, g, b] = ink.to_be_bytes().map(f64::from);
    DVec3::new(r, g, b) / 255.0
}

/// The index of the ink nearest to `wanted`; of those that a `step_offset` makes equally near, the
/// first, or the last where it is below 0.
fn nearest(wanted: DVec3, inks: &[DVec3], step_offset: f64) -> usize {
    let distances = inks.iter().map(|ink| distance(wanted, *ink));
    let least = distances.clone().fold(f64::INFINITY, f64::min);
    let mut near = distances.enumerate().filter(|(_, distance)| {
        *distance <= least + BAND * step_offset.abs()
    });
    let found = if step_offset < 0.0 { near.next_back() } else { near.next() };
    found.map_or(0, |(index, _)| index)
}

/// How different two gamma-encoded colors look, squared.
fn distance(a: DVec3, b: DVec3) -> f64 {
    let apart = a - b;
    let weighted = apart * DVec3::new(0.299, 0.587, 0.114);
    0.75 * weighted.dot(apart) + weighted.element_sum().powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_ink_is_itself_and_between_two_a_step_decides() {
        for list in [Inks::Handheld, Inks::Cga, Inks::Ember, Inks::Arcade] {
            let inks: Vec<DVec3> = list.colors().iter().map(|ink| encoded(*ink)).collect();
            for (index, ink) in inks.iter().enumerate() {
                for step_offset in [0.0, -1e-4, 1e-4] {
                    assert_eq!(nearest(*ink, &inks, step_offset), index, "{list:?}");
                }
            }
            let middle = (inks[0] + inks[1]) / 2.0;
            let [first, last] = [1e-4, -1e-4].map(|offset| nearest(middle, &inks, offset));
            assert!(first <= last, "{list:?}");
        }
        let gray = [0.0, 1.0].map(DVec3::splat);
        let at = |offset: f64| nearest(DVec3::splat(0.5), &gray, offset);
        assert_eq!([at(1e-5), at(-1e-5)], [0, 1]);
    }
}
