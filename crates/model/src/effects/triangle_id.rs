//! Triangle id: gives every triangle its own color.

use glam::DVec3;

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput};
use crate::{
    math::{HASH_GOLDEN, hash},
    params,
};

params! {
    pub struct TriangleId {
        /// How much of the base color is replaced.
        amount: f32 = 1.0, hard 0.0..=1.0;
        /// Another seed, other colors.
        seed: u32 = 0, soft 0.0..=999.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<TriangleId>(
        "triangle_id",
        "TriangleId",
        "gives every triangle its own color",
    )
    .into()
});

impl SurfaceEffect for TriangleId {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::TriangleId,
        SurfaceInput::Glow,
        SurfaceInput::Color,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let h = hash(s.triangle_id ^ p.seed.wrapping_mul(HASH_GOLDEN));
        let byte = |shift: u32| f64::from(h >> shift & 255) / 255.0;
        let shade = DVec3::splat(0.08) + DVec3::new(byte(0), byte(8), byte(16)) * 0.8;
        let base = s.color.truncate();
        s.glow *= 1.0 - f64::from(p.amount);
        s.color = (base + (shade - base) * f64::from(p.amount)).extend(s.color.w);
        s
    }
}
