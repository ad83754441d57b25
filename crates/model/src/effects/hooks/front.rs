//! Fronts: one number per triangle that travels over the model, for effects that come and go
//! triangle by triangle.

use glam::{DVec2, DVec3};

use super::{ErrorBound, ROUNDING};
use crate::{
    choice,
    math::{HASH_GOLDEN, hash_unit},
};

choice! {
    /// How an effect is spread over the triangles.
    pub enum Pattern {
        /// All alike.
        Uniform,
        /// A front that crosses the picture.
        Sweep,
        /// A front that grows round a point.
        Radial,
        /// Each at its own time.
        Random,
    }
}

/// How an effect is spread over the triangles, and where its front stands: words of its parameters.
/// Mirror of the struct in `shaders/lib/front.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Front {
    pub center: [f32; 4],
    pub pattern: u32,
    pub front: f32,
    pub width: f32,
    pub along_x: f32,
    pub along_y: f32,
    pub radius_m: f32,
    pub width_m: f32,
    pub seed: u32,
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
