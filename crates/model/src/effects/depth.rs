//! Depth: shades by distance from the eye, fitted to the scene or by a scale and an offset of your
//! own.

use glam::{DVec3, DVec4};

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput};
use crate::{
    params,
    params::{Color, Flag},
};

params! {
    pub struct Depth {
        /// Color at the near end, linear.
        near: Color = [1.0, 0.93, 0.8, 1.0];
        /// Color at the far end, linear.
        far: Color = [0.015, 0.03, 0.07, 1.0];
        /// Spread the two colors over the depth range of the scene.
        fit: Flag = 1;
        /// Without fit: how much of the way to the far color one meter takes.
        scale: f32 = 0.2, hard -1e6..=1e6, soft 0.0..=2.0, unit "per m", depth true;
        /// Without fit: position of the eye between the two colors, 0 near and 1 far.
        offset: f32 = 0.0, hard -1e6..=1e6, soft -2.0..=2.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Depth>("depth", "Depth", "shades by distance from the eye").into()
});

impl SurfaceEffect for Depth {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Depth,
        SurfaceInput::DepthRange,
        SurfaceInput::Color,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let way = if p.fit != 0 {
            (s.depth_m - s.depth_range_m.x) / (s.depth_range_m.y - s.depth_range_m.x)
        } else {
            s.depth_m * f64::from(p.scale) + f64::from(p.offset)
        };
        let (near, far) = (vec4(p.near), vec4(p.far));
        let shade = near + (far - near) * way.clamp(0.0, 1.0);
        s.glow = DVec3::ZERO;
        s.color = shade.truncate().extend(s.color.w);
        s
    }
}

fn vec4(c: [f32; 4]) -> DVec4 {
    DVec4::new(c[0].into(), c[1].into(), c[2].into(), c[3].into())
}
