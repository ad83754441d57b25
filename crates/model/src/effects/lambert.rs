//! Lambert: diffuse light from a sun, a sky above and ground below, and a headlight.

use glam::{DVec3, DVec4};

use super::{BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput};
use crate::{
    params,
    params::{Color, Point},
};

params! {
    pub struct Lambert {
        /// Color of the sun, linear.
        sun: Color = [0.82, 0.76, 0.66, 1.0];
        /// Light from straight above, linear.
        sky: Color = [0.16, 0.19, 0.24, 1.0];
        /// Light from straight below, linear.
        ground: Color = [0.07, 0.055, 0.045, 1.0];
        /// Direction towards the sun, of any length.
        sun_direction: Point = [0.55, 0.8, 0.6, 0.0], hard -1e3..=1e3, soft -1.0..=1.0;
        /// Strength of a white light at the eye.
        headlight: f32 = 0.08, hard 0.0..=10.0, soft 0.0..=1.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Lambert>(
        "lambert",
        "Lambert",
        "diffuse light from sun, sky, ground and a headlight",
    )
    .into()
});

impl SurfaceEffect for Lambert {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Normal,
        SurfaceInput::View,
        SurfaceInput::Color,
        SurfaceInput::Glow,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let toward = DVec3::new(
            p.sun_direction[0].into(),
            p.sun_direction[1].into(),
            p.sun_direction[2].into(),
        );
        let sun = s
            .normal
            .dot(toward.try_normalize().unwrap_or(DVec3::Y))
            .max(0.0);
        let headlight = s.normal.dot(s.view).max(0.0) * f64::from(p.headlight);
        let up = 0.5 + 0.5 * s.normal.y;
        let light = color(p.sun) * sun
            + color(p.ground)
            + (color(p.sky) - color(p.ground)) * up
            + DVec3::splat(headlight);
        s.color = ((s.color.truncate() - s.glow) * light + s.glow).extend(s.color.w);
        s
    }
}

fn color(c: [f32; 4]) -> DVec3 {
    DVec4::new(c[0].into(), c[1].into(), c[2].into(), c[3].into()).truncate()
}
