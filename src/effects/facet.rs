//! Facet: blends every triangle between smooth and flat, in normal and in depth.
//!
//! The blend is one number per triangle, taken at its centre. At 0 and 1 the pure values come through to the bit.

use super::{
    Effect, Surface, SurfaceEffect, SurfaceInput,
    hooks::{Front, Pattern, front_of},
};
use crate::{params, params::Point};

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
        /// Softness of the front, as a fraction of its path.
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
    const INPUTS: &[SurfaceInput] = &[SurfaceInput::Center, SurfaceInput::CenterScreen, SurfaceInput::TriangleId, SurfaceInput::Depth, SurfaceInput::FlatDepth, SurfaceInput::Normal, SurfaceInput::FlatNormal];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let t = f64::from(p.amount) * p.front().reached(s.center, s.center_screen, s.triangle_id);
        if t <= 0.0 {
            return s;
        }
        s.depth_m += (s.flat_depth_m - s.depth_m) * t;
        let blended = s.normal + (s.flat_normal - s.normal) * t;
        s.normal = if t >= 1.0 || blended.length_squared() < 1e-12 { s.flat_normal } else { blended.normalize() };
        s
    }
}

impl Facet {
    fn front(&self) -> Front {
        front_of!(self)
    }
}
