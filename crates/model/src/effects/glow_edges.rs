//! Glow edges: silhouettes and steps of depth shine like neon tubes in a dark picture.

use glam::{DVec2, DVec3, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect, tone::rgb},
};
use crate::{choice, math::hash_unit, params, params::Color};

choice! {
    /// What color the tubes have.
    pub enum Hue {
        /// Each object a hue of its own.
        Objects = "objects",
        /// The hue of the picture beneath.
        Picture = "picture",
        /// One color.
        One = "one",
    }
}

params! {
    pub struct GlowEdges {
        /// The one color, linear; its alpha is the strength of all tubes.
        color: Color = [0.15, 0.75, 1.0, 1.0];
        /// What color the tubes have.
        hue: Hue = Hue::Objects as u32;
        /// How far the light reaches.
        radius_px: f32 = 16.0, hard 1.0..=256.0, soft 1.0..=64.0, unit "px";
        /// Strength of the light around the tubes.
        intensity: f32 = 3.0, hard 0.0..=32.0, soft 0.0..=8.0;
        /// How much of the picture is seen beneath.
        picture: f32 = 0.12, hard 0.0..=1.0;
        /// The least jump of depth within an object that counts, as a fraction of the distance.
        depth_threshold: f32 = 0.02, hard 0.0001..=1.0, soft 0.001..=0.5, log true;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<GlowEdges>(
        "glow_edges",
        "GlowEdges",
        "silhouettes and steps of depth shine like neon tubes",
    )
    .on_passes::<GlowEdges>()
    .into()
});

/// Triangle id, depth key and object of a pixel.
type Seen = (Option<u32>, u32, u32);

impl PassEffect for GlowEdges {
    const PASSES: &'static [(&'static str, u32)] =
        &[("find", 1), ("across", 2), ("down", 2), ("shine", 1)];

    fn pass(index: usize, at: &ImageAt, p: &Self) -> DVec4 {
        match index {
            0 => p.tube(at),
            1 => p.mean(|i| at.last_at(at.middle() + DVec2::new((2 * i) as f64, 0.0))),
            2 => p.mean(|i| at.last(at.x, at.y + i)),
            _ => p.shine(at),
        }
    }
}

impl GlowEdges {
    fn shine(&self, at: &ImageAt) -> DVec4 {
        let (color, tube) = (at.color(at.x, at.y), self.tube(at));
        // A tube is a pixel wide, so a mean over a larger radius has less of it: the halo is as
        // bright at any size of the picture.
        let strength = f64::from(self.intensity) * (f64::from(self.radius_px) / 16.0);
        let halo = strength * at.last_at(0.5 * at.middle()).truncate();
        // A tube is white in its middle.
        let core = tube.truncate() + tube.w * (0.6 - 0.6 * tube.truncate());
        let dim = f64::from(self.picture) * color.truncate();
        let lit = dim + halo * (1.0 - dim.clamp(DVec3::ZERO, DVec3::ONE));
        (lit + (core - lit) * (tube.w * f64::from(self.color[3]))).extend(color.w)
    }

    /// Weighted mean of what is read at half pixels along a line.
    fn mean(&self, read: impl Fn(i64) -> DVec4) -> DVec4 {
        let radius = 0.5 * f64::from(self.radius_px);
        let reach = radius.ceil() as i64;
        let (mut sum, mut weights) = (DVec4::ZERO, 0.0);
        for i in -reach..=reach {
            let near = (1.0 - (i as f64 / (radius + 1.0)).abs()).max(0.0);
            let weight = near * near * near;
            sum += weight * read(i);
            weights += weight;
        }
        sum / weights
    }

    /// The color of the tube at a pixel, and whether there is one.
    fn tube(&self, at: &ImageAt) -> DVec4 {
        let here = at.input.picture.at(at.x, at.y);
        let is_edge = self.is_edge(at, here, [1, 0]) || self.is_edge(at, here, [0, 1]);
        if here.0.is_none() || !is_edge {
            return DVec4::ZERO;
        }
        let color = match Hue::of(self.hue) {
            Hue::One => rgb(self.color),
            Hue::Picture => {
                let light = at.color(at.x, at.y).truncate().max(DVec3::ZERO);
                light / light.max_element().max(0.001)
            }
            Hue::Objects => {
                let turn = hash_unit(here.2) + DVec3::new(0.0, 2.0 / 3.0, 1.0 / 3.0);
                let hue = (turn - turn.floor()) * 6.0 - 3.0;
                (hue.abs() - 1.0).clamp(DVec3::ZERO, DVec3::ONE)
            }
        };
        color.extend(1.0)
    }

    /// Does a pixel lie on the nearer side of an edge, along an axis?
    fn is_edge(&self, at: &ImageAt, here: Seen, [right, down]: [i64; 2]) -> bool {
        let there = at.input.picture.at(at.x + right, at.y + down);
        let beyond = at.input.picture.at(at.x - right, at.y - down);
        let is_behind = |other: Seen| other.2 != here.2 && other.1 < here.1;
        if is_behind(there) || is_behind(beyond) {
            return true;
        }
        if there.2 != here.2 || beyond.2 != here.2 {
            return false;
        }
        // A slope alone is no step.
        let bend = i64::from(there.1) + i64::from(beyond.1) - 2 * i64::from(here.1);
        bend < -((f64::from(self.depth_threshold) * f64::from(1 << 23)) as i64)
    }
}
