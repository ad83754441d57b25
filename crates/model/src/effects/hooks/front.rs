//! Fronts: one number per triangle that travels over the model, for effects that come and go
//! triangle by triangle.

use glam::{DVec2, DVec3};

use super::{ErrorBound, ROUNDING};
use crate::{
    choice,
    math::{HASH_GOLDEN, hash_unit},
    params,
    params::Point,
};

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

params! {
    /// How an effect is spread over the triangles, and where its front stands. Mirror of the struct in `shaders/lib/front.wgsl`.
    pub struct Front {
        /// Center of the radial front, world space.
        center: Point = [0.0, 0.0, 0.0, 0.0], soft -3.0..=3.0, unit "m", when ("pattern", &["radial"]);
        /// How the effect is spread over the triangles.
        pattern: Pattern = Pattern::Uniform as u32;
        /// Progress of the front: 0 before the first triangle, 1 past the last.
        front: f32 = 0.5, hard 0.0..=1.0, when ("pattern", &["sweep", "random"]);
        /// Softness of the front, as a fraction of its path.
        width: f32 = 0.25, hard 0.001..=100.0, soft 0.001..=2.0, log true, when ("pattern", &["sweep", "random"]);
        /// Direction of the sweep in the picture: part to the right.
        along_x: f32 = 1.0, hard -1.0..=1.0, when ("pattern", &["sweep"]);
        /// Direction of the sweep in the picture: part downwards.
        along_y: f32 = 0.0, hard -1.0..=1.0, when ("pattern", &["sweep"]);
        /// Distance of the front from the center.
        radius_m: f32 = 1.0, hard 0.0..=1e6, soft 0.0..=5.0, unit "m", when ("pattern", &["radial"]);
        /// Thickness of the front.
        width_m: f32 = 0.5, hard 0.001..=1e6, soft 0.01..=5.0, unit "m", log true, when ("pattern", &["radial"]);
        /// Seed of everything random in the effect.
        seed: u32 = 1, soft 0.0..=999.0, when ("pattern", &["random"]);
    }
}

impl Front {
    /// How the effect is spread.
    pub fn pattern(&self) -> Pattern {
        Pattern::of(self.pattern)
    }

    /// How far the front has passed a triangle: 0 untouched, 1 behind it.
    pub fn reached(&self, center: DVec3, center_screen: DVec2, triangle: u32) -> f64 {
        self.passed(center, center_screen, triangle).clamp(0.0, 1.0)
    }

    /// The same in thicknesses of the front, below 0 before it and above 1 behind it.
    fn passed(&self, center: DVec3, center_screen: DVec2, triangle: u32) -> f64 {
        let width = f64::from(self.width);
        let passed =
            |path_position: f64| (f64::from(self.front) * (1.0 + width) - path_position) / width;
        match self.pattern() {
            Pattern::Uniform => 1.0,
            Pattern::Sweep => {
                passed(0.5 + (center_screen - 0.5).dot(self.along()) / self.sweep_length())
            }
            Pattern::Radial => {
                (f64::from(self.radius_m) - self.distance(center)) / f64::from(self.width_m) + 0.5
            }
            Pattern::Random => passed(hash_unit(triangle ^ self.seed.wrapping_mul(HASH_GOLDEN))),
        }
    }

    /// Direction of the sweep in the picture.
    fn along(&self) -> DVec2 {
        DVec2::new(self.along_x.into(), self.along_y.into())
    }

    /// Length of the sweep's path over the picture.
    fn sweep_length(&self) -> f64 {
        (self.along().x.abs() + self.along().y.abs()).max(1e-3)
    }

    /// Distance from the center of the radial front, meters.
    fn distance(&self, center: DVec3) -> f64 {
        (center
            - DVec3::new(
                self.center[0].into(),
                self.center[1].into(),
                self.center[2].into(),
            ))
        .length()
    }

    /// Bound of the error of the f32 side of [`Front::reached`]: first-order roundings, each of the
    /// terms that it concerns.
    pub fn error_bound(
        &self,
        center: DVec3,
        center_screen: DVec2,
        triangle: u32,
        given: &ErrorBound,
    ) -> f64 {
        let passed = self.passed(center, center_screen, triangle);
        let (width, width_m) = (f64::from(self.width), f64::from(self.width_m));
        let progress = 3.0 * ROUNDING * f64::from(self.front) * (1.0 + width);
        let error_bound = match self.pattern() {
            Pattern::Uniform => return 0.0,
            Pattern::Sweep => {
                let direction = self.along().abs() / self.sweep_length();
                let path = direction.dot((center_screen - 0.5).abs());
                let position = (direction.x + direction.y) * given.center_screen
                    + ROUNDING * (1.0 + 8.0 * path);
                (progress + position) / width
            }
            Pattern::Radial => {
                (2.0 * given.center_m
                    + ROUNDING * (8.0 * self.distance(center) + f64::from(self.radius_m)))
                    / width_m
            }
            Pattern::Random => progress / width,
        } + 4.0 * ROUNDING * (passed.abs() + 1.0);
        // Away from the front both ends are exact.
        if passed + error_bound < 0.0 || passed - error_bound > 1.0 {
            0.0
        } else {
            error_bound.min(1.0)
        }
    }
}
