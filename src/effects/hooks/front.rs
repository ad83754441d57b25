//! Fronts: one number per triangle that travels over the model, for effects that come and go triangle by triangle.

use glam::{DVec2, DVec3};

use super::Facts;
use crate::{choice, math::hash_unit};

choice! {
    /// How an effect is spread over the triangles.
    pub enum Pattern {
        /// All alike.
        Uniform = "uniform",
        /// A front that crosses the picture.
        Sweep = "sweep",
        /// A front that grows round a point.
        Radial = "radial",
        /// Each at its own time.
        Random = "random",
    }
}

/// Where a front stands. Twin of `shaders/common/front.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Front {
    pub pattern: Pattern,
    /// Progress: 0 before the first triangle, 1 past the last.
    pub progress: f64,
    /// Softness, as a share of its way.
    pub width: f64,
    /// Direction in the picture.
    pub along: DVec2,
    /// Centre of a radial front, world space.
    pub center: DVec3,
    pub radius_m: f64,
    /// Thickness of a radial front.
    pub width_m: f64,
    pub seed: u32,
}

impl Front {
    /// How far the front has passed a triangle: 0 untouched, 1 behind it.
    pub fn reached(&self, center: DVec3, center_screen: DVec2, triangle: u32) -> f64 {
        let passed = |place: f64| ((self.progress * (1.0 + self.width) - place) / self.width).clamp(0.0, 1.0);
        match self.pattern {
            Pattern::Uniform => 1.0,
            Pattern::Sweep => {
                let reach = (self.along.x.abs() + self.along.y.abs()).max(1e-3);
                passed(0.5 + (center_screen - 0.5).dot(self.along) / reach)
            }
            Pattern::Radial => ((self.radius_m - (center - self.center).length()) / self.width_m + 0.5).clamp(0.0, 1.0),
            Pattern::Random => passed(hash_unit(triangle ^ self.seed.wrapping_mul(0x9e37_79b9))),
        }
    }

    /// Bound of the error of [`Front::reached`] in f32, whatever rounding, order and fusion WGSL allows.
    pub fn slack(&self, facts: &Facts) -> f64 {
        let ulp = f64::from(f32::EPSILON);
        let passing = |place_slack: f64| (place_slack + 8.0 * ulp * (1.0 + self.width)) / self.width;
        match self.pattern {
            Pattern::Uniform => 0.0,
            // Shares of the picture: a few operations on numbers up to the largest corner's place.
            Pattern::Sweep => {
                let reach = facts.corners.as_flattened().iter().map(|at| f64::from(*at).abs()).fold(0.0, f64::max);
                let shortest = f64::from(facts.size[0].min(facts.size[1]).max(1));
                passing(24.0 * ulp * (1.0 + reach / (256.0 * shortest)))
            }
            Pattern::Radial => {
                let away = (facts.center - self.center).length();
                let distance = 2.0 * facts.center_slack_m + 8.0 * ulp * (away + self.center.abs().max_element());
                (distance + 4.0 * ulp * self.radius_m) / self.width_m + 4.0 * ulp
            }
            Pattern::Random => passing(0.0),
        }
    }
}
