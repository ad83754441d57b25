//! Shadow: a directional light with a shadow map, which the rasterizer itself draws from the light.
//!
//! Light does not reach a sample that is deeper than what the light sees there. A tap compares one
//! texel with the plane of the sample's triangle at the center of that texel, moved towards the
//! light by a bias: a constant, and a slope that grows with the tangent of the angle at which light
//! meets the plane, both in texels.

use glam::DVec3;

use super::{BuiltIn, Effect, hooks::tone::turned};
use crate::{choice, words};

choice! {
    /// What the light does.
    pub enum Shading {
        /// It shines on a matt surface (Lambert), with light from above and below where it does not arrive.
        Lambert,
        /// It only dims what earlier effects have shaded.
        Dim,
    }
}

words! {
    pub struct Shadow of "shadow" {
        light: [f32; 4],
        sky: [f32; 4],
        ground: [f32; 4],
        azimuth_deg: f32,
        elevation_deg: f32,
        shading: u32,
        strength: f32,
        bias: f32,
        slope: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Shadow>().with_shadows().into()
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
