//! Environments that several effects show: a sky, a ground and three lamps, which are spherical
//! Gaussians.
//!
//! All that is asked of one is a formula: the light on a matt surface is the sum of its spherical
//! harmonics up to the second band (Ramamoorthi and Hanrahan 2001), and a rough mirror shows it
//! blurred by lobes fitted to that of GGX about the normal.

use glam::{DVec2, DVec3};

use crate::{choice, scene::panorama::Panorama};

choice! {
    /// What surrounds the scene.
    pub enum Environment {
        /// A dim room with a large lamp at the left, one at the right and one behind.
        Studio,
        /// A bright gray sky.
        Overcast,
        /// A low sun at the right in front, under a sky that is orange below and blue above.
        LowSun,
        /// The moon, a street lamp and a colored sign.
        Night,
        /// The picture that the preset names as `scene.surroundings`; without one the studio.
        Picture,
    }
}

/// What an effect shows of an environment: a formula, or the picture of the scene's surroundings.
pub struct Seen<'a> {
    formula: Surroundings,
    picture: Option<&'a Panorama>,
}

impl<'a> Seen<'a> {
    pub fn of(environment: Environment, picture: Option<&'a Panorama>) -> Self {
        Self {
            formula: Surroundings::of(environment),
            picture: picture.filter(|_| environment == Environment::Picture),
        }
    }

    /// As [`Surroundings::irradiance`].
    pub fn irradiance(&self, normal: DVec3) -> DVec3 {
        match self.picture {
            Some(picture) => picture.irradiance(normal),
            None => self.formula.irradiance(normal),
        }
    }

    /// As [`Surroundings::radiance`].
    pub fn radiance(&self, d: DVec3, alpha: f64) -> DVec3 {
        match self.picture {
            Some(picture) => picture.radiance(d, alpha, DVec2::ZERO),
            None => self.formula.radiance(d, alpha),
        }
    }
}

/// A light of an environment: a lobe about a direction.
pub struct Lamp {
    /// Unit vector.
    pub toward: DVec3,
    /// Mean cosine of the angle between its light and its direction.
    pub mean: f64,
    /// What a white matt surface that faces it shows, apart from the width of the lobe; linear RGB.
    pub light: DVec3,
}

/// An environment: light from above, from the horizon and from below, and lamps. Linear RGB.
pub struct Surroundings {
    pub zenith: DVec3,
    pub horizon: DVec3,
    pub ground: DVec3,
    pub lamps: [Lamp; 3],
}

impl Surroundings {
    pub fn of(environment: Environment) -> Self {
        let sky = |[zenith, horizon, ground]: [[f64; 3]; 3],
                   lamps: [([f64; 3], f64, [f64; 3]); 3]| {
            Self {
                zenith: zenith.into(),
                horizon: horizon.into(),
                ground: ground.into(),
                lamps: lamps.map(|(toward, mean, light)| Lamp {
                    toward: toward.into(),
                    mean,
                    light: light.into(),
                }),
            }
        };
        const NONE: ([f64; 3], f64, [f64; 3]) = ([0.0, 1.0, 0.0], 0.84, [0.0; 3]);
        match environment {
            Environment::Studio | Environment::Picture => sky(
                [[0.46, 0.47, 0.5], [0.2, 0.205, 0.215], [0.09, 0.085, 0.08]],
                [
                    ([-0.55, 0.62, 0.559553], 0.955, [0.58, 0.56, 0.52]),
                    ([0.86, 0.28, 0.426615], 0.95, [0.16, 0.17, 0.19]),
                    ([0.2, 0.5, -0.842615], 0.98, [0.34, 0.35, 0.38]),
                ],
            ),
            Environment::Overcast => sky(
                [[0.86, 0.9, 0.95], [0.5, 0.53, 0.57], [0.16, 0.15, 0.135]],
                [([0.28, 0.8, 0.53066], 0.84, [0.2, 0.2, 0.195]), NONE, NONE],
            ),
            Environment::LowSun => sky(
                [[0.13, 0.2, 0.36], [0.62, 0.4, 0.27], [0.1, 0.075, 0.06]],
                [
                    ([0.6, 0.14, 0.787655], 0.995, [0.42, 0.25, 0.1]),
                    ([0.6, 0.14, 0.787655], 0.88, [0.42, 0.2, 0.07]),
                    ([-0.6, 0.3, -0.74162], 0.84, [0.06, 0.075, 0.13]),
                ],
            ),
            Environment::Night => sky(
                [
                    [0.006, 0.01, 0.024],
                    [0.03, 0.038, 0.06],
                    [0.012, 0.011, 0.012],
                ],
                [
                    ([-0.5, 0.62, 0.604649], 0.995, [0.12, 0.15, 0.22]),
                    ([0.84, 0.16, 0.518459], 0.98, [0.3, 0.16, 0.05]),
                    ([-0.86, 0.1, -0.5004], 0.96, [0.02, 0.1, 0.12]),
                ],
            ),
        }
    }

    /// Light that a white matt surface shows: the spherical harmonics of the environment up to the
    /// second band, of a hemisphere of light, of light that grows with the height, and of each
    /// lamp.
    pub fn irradiance(&self, normal: DVec3) -> DVec3 {
        let y = normal.y;
        let above = 0.25 + y / 3.0 + (0.117_187_5 * y * y - 0.039_062_5);
        let sky = self.ground * (0.5 - 0.5 * y)
            + self.horizon * (0.5 + 0.5 * y - above)
            + self.zenith * above;
        let lamps = self.lamps.iter().map(|lamp| lamp.irradiance(normal));
        (sky + lamps.sum::<DVec3>()).max(DVec3::ZERO)
    }

    /// What a mirror whose microfacets have this roughness shows in a direction; at 0, the
    /// environment itself.
    pub fn radiance(&self, d: DVec3, alpha: f64) -> DVec3 {
        let mean = 1.0 - blur(alpha);
        // The horizon is soft, so that it is seen alike in f32.
        let width = (0.0016 + 3.0 * blur(alpha)).sqrt();
        let y = d.y * mean;
        let t = ((y + width) / (2.0 * width)).clamp(0.0, 1.0);
        let upper = t * t * (3.0 - 2.0 * t);
        // The integral of that: how high the visible sky is.
        let above = 2.0 * width * t * t * t * (1.0 - 0.5 * t) + (y - width).max(0.0);
        let sky =
            self.ground * (1.0 - upper) + self.horizon * (upper - above) + self.zenith * above;
        let lamps = self.lamps.iter().map(|lamp| lamp.radiance(d, alpha));
        sky + lamps.sum::<DVec3>()
    }
}

impl Lamp {
    pub fn irradiance(&self, normal: DVec3) -> DVec3 {
        let c = normal.dot(self.toward);
        let second = 1.0 - 3.0 * self.mean / concentration(self.mean);
        self.light * (0.25 + 0.5 * self.mean * c + 0.3125 * second * (1.5 * c * c - 0.5))
    }

    /// As a mirror shows it whose microfacets have this roughness. A smooth one blurs it by a lobe
    /// that is as bright in its middle as that of GGX; fitted within 2 %. A matt one is as any matt
    /// surface.
    pub fn radiance(&self, d: DVec3, alpha: f64) -> DVec3 {
        let squared = alpha * alpha;
        let spread = 2.0 * squared / (1.0 + alpha * (0.6749 + 2.3251 * alpha));
        let narrow = concentration(self.mean);
        let sharp = narrow / (1.0 + narrow * spread);
        let lobe = libm::exp(sharp * (d.dot(self.toward) - 1.0));
        let lobe = self.light * (0.5 * sharp / (1.0 - libm::exp(-2.0 * sharp)) * lobe);
        lobe.lerp(self.irradiance(d).max(DVec3::ZERO), squared)
    }
}

/// Concentration of a spherical Gaussian with this mean cosine (Banerjee and others 2005).
fn concentration(mean: f64) -> f64 {
    mean * (3.0 - mean * mean) / (1.0 - mean * mean)
}

/// How far below 1 the mean cosine lies of what GGX mirrors about the normal, weighted with its
/// cosine; fitted within 0.004, and a third at 1.
fn blur(alpha: f64) -> f64 {
    alpha * alpha / (0.1272 + alpha * (0.8497 + 2.0231 * alpha))
}

/// A direction in a sky that is turned about the vertical axis, by an angle with this cosine and
/// sine.
pub fn turned_by(d: DVec3, turn: DVec2) -> DVec3 {
    DVec3::new(
        turn.x * d.x - turn.y * d.z,
        d.y,
        turn.y * d.x + turn.x * d.z,
    )
}
