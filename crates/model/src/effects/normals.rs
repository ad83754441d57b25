//! Normals: colors the surface by the direction it faces, x red, y green, z blue.

use glam::DVec3;

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput};
use crate::params;

params! {
    pub struct Normals {
        /// How much of the base color is replaced.
        amount: f32 = 1.0, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Normals>(
        "normals",
        "Normals",
        "colors the surface by the direction it faces",
    )
    .into()
});

impl SurfaceEffect for Normals {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Normal,
        SurfaceInput::Glow,
        SurfaceInput::Color,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let shade = s.normal * 0.5 + DVec3::splat(0.5);
        let base = s.color.truncate();
        s.glow *= 1.0 - f64::from(p.amount);
        s.color = (base + (shade - base) * f64::from(p.amount)).extend(s.color.w);
        s
    }
}
