//! Fronts: one number per triangle that travels over the model, for effects that come and go triangle by triangle.

use glam::{DVec2, DVec3};

use super::{ErrorBound, ROUNDING};
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
    /// Deformation, as a share of its way.
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
        self.passed(center, center_screen, triangle).clamp(0.0, 1.0)
    }

    /// The same in thicknesses of the front, below 0 before it and above 1 behind it.
    fn passed(&self, center: DVec3, center_screen: DVec2, triangle: u32) -> f64 {
        let passed = |place: f64| (self.progress * (1.0 + self.width) - place) / self.width;
        match self.pattern {
            Pattern::Uniform => 1.0,
            Pattern::Sweep => passed(0.5 + (center_screen - 0.5).dot(self.along) / self.reach()),
            Pattern::Radial => (self.radius_m - (center - self.center).length()) / self.width_m + 0.5,
            Pattern::Random => passed(hash_unit(triangle ^ self.seed.wrapping_mul(0x9e37_79b9))),
        }
    }

    /// Length of the sweep's way over the picture.
    fn reach(&self) -> f64 {
        (self.along.x.abs() + self.along.y.abs()).max(1e-3)
    }

    /// Bound of the error of an f32 twin of [`Front::reached`]: first-order roundings, each of the terms it concerns.
    pub fn error_bound(&self, center: DVec3, center_screen: DVec2, triangle: u32, given: &ErrorBound) -> f64 {
        let passed = self.passed(center, center_screen, triangle);
        let progress = 3.0 * ROUNDING * self.progress * (1.0 + self.width);
        let error_bound = match self.pattern {
            Pattern::Uniform => return 0.0,
            Pattern::Sweep => {
                let share = self.along.abs() / self.reach();
                let way = share.dot((center_screen - 0.5).abs());
                let place = (share.x + share.y) * given.center_screen + ROUNDING * (1.0 + 8.0 * way);
                (progress + place) / self.width
            }
            Pattern::Radial => {
                let distance = (center - self.center).length();
                (2.0 * given.center_m + ROUNDING * (8.0 * distance + self.radius_m)) / self.width_m
            }
            Pattern::Random => progress / self.width,
        } + 4.0 * ROUNDING * (passed.abs() + 1.0);
        // Away from the front both ends are exact.
        if passed + error_bound < 0.0 || passed - error_bound > 1.0 { 0.0 } else { error_bound.min(1.0) }
    }
}

/// The [`Front`] of a parameter struct that names its fields as all such effects do.
macro_rules! front_of {
    ($p:expr) => {
        $crate::effects::hooks::Front {
            pattern: $crate::effects::hooks::Pattern::of($p.pattern),
            progress: $p.front.into(),
            width: $p.width.into(),
            along: glam::DVec2::new($p.along_x.into(), $p.along_y.into()),
            center: glam::DVec3::new($p.center[0].into(), $p.center[1].into(), $p.center[2].into()),
            radius_m: $p.radius_m.into(),
            width_m: $p.width_m.into(),
            seed: $p.seed,
        }
    };
}
pub(crate) use front_of;
