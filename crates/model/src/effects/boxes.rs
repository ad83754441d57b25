//! Boxes: fills the whole bounding box of every triangle, as a rasterizer without its inside test
//! would.
//!
//! The box lies at the depth of the triangle's nearest corner, so that boxes hide each other one by
//! one. Beyond the triangle its surface continues as it is on the nearest edge.

use glam::DVec3;

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput, hooks::Slot};
use crate::{params, params::Color};

params! {
    pub struct Boxes {
        /// Color of what lies beyond the triangle; alpha is its weight against the surface's color.
        tint: Color = [1.0, 0.2, 0.1, 0.0];
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Boxes>(
        "boxes",
        "Boxes",
        "fills the whole bounding box of every triangle",
    )
    .in_slot(Slot::Coverage)
    .on_surface::<Boxes>()
    .into()
});

impl SurfaceEffect for Boxes {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Barycentrics,
        SurfaceInput::Glow,
        SurfaceInput::Color,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        // Beyond the triangle at least one barycentric coordinate is clamped to zero.
        if s.barycentrics.min_element() <= 0.0 {
            let [red, green, blue, weight] = p.tint.map(f64::from);
            s.glow *= 1.0 - weight;
            s.color = s
                .color
                .truncate()
                .lerp(DVec3::new(red, green, blue), weight)
                .extend(s.color.w);
        }
        s
    }
}
