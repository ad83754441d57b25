//! Fog: blends towards a color with distance (Beer–Lambert).
//!
//! The surface's light is multiplied by exp(-density · path), where the path is the depth beyond
//! the start, and thinner above a level.

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput, hooks::tone::rgb};
use crate::{params, params::Color};

params! {
    pub struct Fog {
        /// Color of the fog, linear.
        color: Color = [0.36, 0.44, 0.55, 1.0];
        /// Extinction coefficient: light falls as exp(-density · path).
        density: f32 = 0.35, hard 0.0..=1e4, soft 0.0..=2.0, unit "per m", depth true;
        /// Depth at which the fog begins.
        start_m: f32 = 3.0, hard 0.0..=1e6, soft 0.0..=20.0, unit "m", depth true;
        /// How fast the fog thins out above the level; 0 is as thick everywhere.
        falloff: f32 = 0.0, hard 0.0..=1e3, soft 0.0..=4.0, unit "per m";
        /// Height up to which the fog is whole, world space.
        level_m: f32 = 0.0, hard -1e6..=1e6, soft -3.0..=3.0, unit "m", height true;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Fog>("fog", "Fog", "blends towards a color with distance").into()
});

impl SurfaceEffect for Fog {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Position,
        SurfaceInput::Depth,
        SurfaceInput::Glow,
        SurfaceInput::Color,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let above = (s.position.y - f64::from(p.level_m)).max(0.0);
        let thickness = f64::from(p.density) * libm::exp(-above * f64::from(p.falloff));
        let path = (s.depth_m - f64::from(p.start_m)).max(0.0);
        let fog = 1.0 - libm::exp(-thickness * path);
        let base = s.color.truncate();
        s.glow *= 1.0 - fog;
        s.color = (base + (rgb(p.color) - base) * fog).extend(s.color.w);
        s
    }
}
