//! Facet: blends every triangle between smooth and flat, in normal and in depth.
//!
//! The blend is one number per triangle, taken at its center. At 0 and 1 the pure values come
//! through to the bit.

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput, hooks::Front};
use crate::params;

params! {
    pub struct Facet {
        ..spread: Front = Front::default(), always_shown "";
        /// How flat a triangle becomes: 0 keeps it smooth, 1 is fully flat.
        amount: f32 = 1.0, hard 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Facet>(
        "facet",
        "Facet",
        "blends every triangle between smooth and flat, in normal and in depth",
    )
    .into()
});

impl SurfaceEffect for Facet {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Center,
        SurfaceInput::CenterScreen,
        SurfaceInput::TriangleId,
        SurfaceInput::Depth,
        SurfaceInput::FlatDepth,
        SurfaceInput::Normal,
        SurfaceInput::FlatNormal,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let t = f64::from(p.amount) * p.spread.reached(s.center, s.center_screen, s.triangle_id);
        if t <= 0.0 {
            return s;
        }
        s.depth_m += (s.flat_depth_m - s.depth_m) * t;
        let blended = s.normal + (s.flat_normal - s.normal) * t;
        s.normal = if t >= 1.0 || blended.length_squared() < 1e-12 {
            s.flat_normal
        } else {
            blended.normalize()
        };
        s
    }
}
