//! Shadow: a directional light with a shadow map, which the rasterizer itself draws from the light.
//!
//! Light does not reach a sample that is deeper than what the light sees there. A tap compares one
//! texel with the plane of the sample's triangle at the center of that texel, moved towards the
//! light by a bias: a constant, and a slope that grows with the tangent of the angle at which light
//! meets the plane, both in texels.

use glam::DVec3;

use super::{
    BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput,
    hooks::tone::{rgb, turned},
};
use crate::{choice, params, params::Color};

choice! {
    /// What the light does.
    pub enum Shading {
        /// It shines on a matt surface (Lambert), with light from above and below where it does not arrive.
        Lambert = "lambert",
        /// It only dims what earlier effects have shaded.
        Dim = "dim",
    }
}

params! {
    pub struct Shadow {
        /// Color of the light, linear.
        light: Color = [0.92, 0.84, 0.70, 1.0], when ("shading", &["lambert"]);
        /// Light from straight above that nothing stops, linear.
        sky: Color = [0.16, 0.19, 0.24, 1.0], when ("shading", &["lambert"]);
        /// Light from straight below that nothing stops, linear.
        ground: Color = [0.08, 0.065, 0.055, 1.0], when ("shading", &["lambert"]);
        /// Where the light comes from: 0 in front of the scene, 90 from its right.
        azimuth_deg: f32 = 40.0, hard -36000.0..=36000.0, soft -180.0..=180.0, unit "°";
        /// Elevation of the light: 90 straight above.
        elevation_deg: f32 = 48.0, hard -90.0..=90.0, unit "°";
        /// What the light does.
        shading: Shading = Shading::Lambert as u32;
        /// Fraction of the light that a shadow removes.
        strength: f32 = 1.0, hard 0.0..=1.0;
        /// How many texels a surface is moved towards the light before it is compared.
        bias: f32 = 0.5, hard -64.0..=64.0, soft 0.0..=4.0;
        /// The same for every unit of the tangent of the angle between the light and the surface's normal.
        slope: f32 = 0.25, hard -64.0..=64.0, soft 0.0..=4.0;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::surface::<Shadow>(
        "shadow",
        "Shadow",
        "a directional light whose shadows the rasterizer draws itself",
    )
    .in_steps()
    .with_shadows()
    .into()
});

/// Largest tangent that counts, for the slope and for the plane of a triangle between taps.
pub const MAX_SHADOW_SLOPE: f64 = 8.0;

impl Shadow {
    /// Turns the light to where `sun` is, a direction of any length. A light that is turned away
    /// from its default turns the sun instead.
    pub fn face(&mut self, sun: &mut [f32; 4]) {
        let default = Self::default();
        let is_turned = [self.azimuth_deg, self.elevation_deg]
            != [default.azimuth_deg, default.elevation_deg];
        let toward = DVec3::from([0, 1, 2].map(|axis| f64::from(sun[axis])));
        if is_turned {
            let [x, y, z] = self.toward().as_vec3().to_array();
            *sun = [x, y, z, sun[3]];
        } else if let Some(toward) = toward.try_normalize() {
            self.azimuth_deg = libm::atan2(toward.x, toward.z).to_degrees() as f32;
            self.elevation_deg = libm::asin(toward.y.clamp(-1.0, 1.0)).to_degrees() as f32;
        }
    }

    /// Unit vector towards the light.
    pub fn toward(&self) -> DVec3 {
        let [azimuth, elevation] =
            [self.azimuth_deg, self.elevation_deg].map(|degrees| turned(degrees.into()));
        DVec3::new(
            elevation.x * azimuth.y,
            elevation.y,
            elevation.x * azimuth.x,
        )
    }
}

impl SurfaceEffect for Shadow {
    const INPUTS: &[SurfaceInput] = &[
        SurfaceInput::Normal,
        SurfaceInput::Lit,
        SurfaceInput::Color,
        SurfaceInput::Glow,
    ];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let facing = s.normal.dot(p.toward()).max(0.0);
        let arrives = 1.0 - f64::from(p.strength) * (1.0 - s.lit);
        let light = match Shading::of(p.shading) {
            Shading::Lambert => {
                let up = 0.5 + 0.5 * s.normal.y;
                rgb(p.light) * (facing * arrives)
                    + rgb(p.ground)
                    + (rgb(p.sky) - rgb(p.ground)) * up
            }
            // A surface that the light grazes was dim before.
            Shading::Dim => {
                DVec3::splat(1.0 - f64::from(p.strength) * (1.0 - s.lit * (4.0 * facing).min(1.0)))
            }
        };
        s.color = ((s.color.truncate() - s.glow) * light + s.glow).extend(s.color.w);
        s
    }
}
