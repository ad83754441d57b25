//! Facet: blends every triangle between smooth and flat, in normal and in depth.
//!
//! The blend is one number per triangle, taken at its centre. At 0 and 1 the pure values come through to the bit.

use glam::DVec3;

use super::{Effect, Surface, SurfaceEffect};
use crate::{choice, math::hash_unit, params, params::Point};

choice! {
    /// How the blend is spread over the triangles.
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
    pub struct Facet {
        /// Centre of the radial front, world space.
        center: Point = [0.0, 0.0, 0.0, 0.0], soft -3.0..=3.0, unit "m", when ("pattern", &["radial"]);
        /// How flat a triangle becomes: 0 keeps it smooth, 1 is fully flat.
        amount: f32 = 1.0, hard 0.0..=1.0;
        /// How the blend is spread over the triangles.
        pattern: Pattern = Pattern::Uniform as u32;
        /// Progress of the front: 0 before the first triangle, 1 past the last.
        front: f32 = 0.5, hard 0.0..=1.0, when ("pattern", &["sweep", "random"]);
        /// Softness of the front, as a share of its way.
        width: f32 = 0.25, hard 0.001..=100.0, soft 0.001..=2.0, log true, when ("pattern", &["sweep", "random"]);
        /// Direction of the sweep in the picture: part to the right.
        along_x: f32 = 1.0, hard -1.0..=1.0, when ("pattern", &["sweep"]);
        /// Direction of the sweep in the picture: part downwards.
        along_y: f32 = 0.0, hard -1.0..=1.0, when ("pattern", &["sweep"]);
        /// Distance of the front from the centre.
        radius_m: f32 = 1.0, hard 0.0..=1e6, soft 0.0..=5.0, unit "m", when ("pattern", &["radial"]);
        /// Thickness of the front.
        width_m: f32 = 0.5, hard 0.001..=1e6, soft 0.01..=5.0, unit "m", log true, when ("pattern", &["radial"]);
        /// Seed of the random times.
        seed: u32 = 1, soft 0.0..=999.0, when ("pattern", &["random"]);
    }
}

pub const EFFECT: Effect =
    Effect::surface::<Facet>("facet", "Facet", "blends every triangle between smooth and flat, in normal and in depth");

impl SurfaceEffect for Facet {
    fn apply(mut s: Surface, p: &Self) -> Surface {
        let t = f64::from(p.amount) * reached(&s, p);
        if t <= 0.0 {
            return s;
        }
        s.depth_m += (s.flat_depth_m - s.depth_m) * t;
        let blended = s.normal + (s.flat_normal - s.normal) * t;
        s.normal = if t >= 1.0 || blended.length_squared() < 1e-12 { s.flat_normal } else { blended.normalize() };
        s
    }
}

/// How far the front has passed the triangle: 0 untouched, 1 behind it.
fn reached(s: &Surface, p: &Facet) -> f64 {
    let (front, width) = (f64::from(p.front), f64::from(p.width));
    let passed = |place: f64| ((front * (1.0 + width) - place) / width).clamp(0.0, 1.0);
    match Pattern::of(p.pattern) {
        Pattern::Uniform => 1.0,
        Pattern::Sweep => {
            let (x, y) = (f64::from(p.along_x), f64::from(p.along_y));
            let reach = (x.abs() + y.abs()).max(1e-3);
            passed(0.5 + ((s.center_screen.x - 0.5) * x + (s.center_screen.y - 0.5) * y) / reach)
        }
        Pattern::Radial => {
            let center = DVec3::new(p.center[0].into(), p.center[1].into(), p.center[2].into());
            let (radius, width) = (f64::from(p.radius_m), f64::from(p.width_m));
            ((radius - (s.center - center).length()) / width + 0.5).clamp(0.0, 1.0)
        }
        Pattern::Random => passed(hash_unit(s.owner ^ p.seed.wrapping_mul(0x9e37_79b9))),
    }
}
