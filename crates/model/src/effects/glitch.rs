//! Glitch: rows and blocks of the picture slip aside, and its colors part, as in a broken
//! transmission.

use glam::{DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect},
};
use crate::{
    math::{HASH_GOLDEN, hash, hash_unit},
    params,
};

params! {
    pub struct Glitch {
        /// How much of the picture is torn.
        amount: f32 = 0.35, hard 0.0..=1.0;
        /// Height of a row that slips.
        row_px: u32 = 4, hard 1.0..=256.0, soft 1.0..=32.0, unit "px";
        /// How far a row slips at most.
        shift_px: u32 = 40, hard 0.0..=4096.0, soft 0.0..=256.0, unit "px";
        /// How far red and blue part, each way; three times as far where the picture is torn.
        split_px: u32 = 2, hard 0.0..=256.0, soft 0.0..=32.0, unit "px";
        /// How many blocks slip beside rows.
        blocks: f32 = 0.4, hard 0.0..=1.0;
        /// Strength of the snow where the picture is torn.
        noise: f32 = 0.05, hard 0.0..=1.0;
        /// Another seed tears the picture elsewhere.
        seed: u32 = 7, hard 0.0..=65535.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Glitch>("glitch", "Glitch", "a broken transmission: rows slip, colors part")
        .on_passes::<Glitch>()
        .into()
});

impl PassEffect for Glitch {
    const PASSES: &'static [(&'static str, u32)] = &[("", 1)];

    fn pass(_: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let seed = hash(p.seed.wrapping_mul(HASH_GOLDEN));
        let [x, y] = [at.x, at.y].map(|place| place as u32);
        let row = y / p.row_px;
        let amount = f64::from(p.amount);
        // Rows slip together in groups of four, and a few by themselves.
        let group = hash(seed.wrapping_add(row / 4));
        let alone = hash(seed ^ row.wrapping_mul(HASH_GOLDEN));
        let mut shift = 0;
        if hash_unit(group) < amount {
            shift += shift_of(group, p.shift_px) / 3;
        }
        if hash_unit(alone) < amount * amount {
            shift += shift_of(alone, p.shift_px);
        }
        let column = x / (p.row_px * 6);
        let block = hash(hash(seed.wrapping_add(column)).wrapping_add(row / 2));
        let is_block = hash_unit(block) < 0.25 * f64::from(p.blocks) * amount;
        if is_block {
            shift += shift_of(hash(block), p.shift_px);
        }
        let is_torn = shift != 0;
        let split = i64::from(p.split_px) * if is_block || is_torn { 3 } else { 1 };
        let x_there = at.x + shift;
        let middle = at.color(x_there, at.y);
        let colors = DVec3::new(
            at.color(x_there - split, at.y).x,
            middle.y,
            at.color(x_there + split, at.y).z,
        );
        let snow = hash_unit(hash(alone.wrapping_add(x / 2)).wrapping_add(y)) - 0.5;
        let torn = if is_torn { f64::from(p.noise) * snow } else { 0.0 };
        (colors + torn).max(DVec3::ZERO).extend(middle.w)
    }
}

/// By how many pixels what has this hash slips, to either side.
fn shift_of(seed: u32, most: u32) -> i64 {
    i64::from(hash(seed) % (2 * most + 1)) - i64::from(most)
}
