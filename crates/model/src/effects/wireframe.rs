//! Wireframe: draws the edges of triangles at a constant width in pixels.
//!
//! A sample lies within w of an edge of length l when its doubled area with the edge is at most
//! w·l: one integer is compared with another, which is computed once per triangle. Edges that
//! clipping added are not drawn.

use super::{
    BuiltIn, Effect, Surface, SurfaceEffect, SurfaceInput,
    hooks::{Sample, SampleEffect, TriangleSetup},
};
use crate::{choice, params, params::Color};

choice! {
    /// What becomes of lines behind faces.
    pub enum Hidden {
        /// Faces are empty, so lines behind them show.
        Shown = "shown",
        /// Faces are filled and hide them.
        Removed = "removed",
    }
}

params! {
    pub struct Wireframe {
        /// Color of the lines; alpha is its weight against the surface's color.
        ink: Color = [0.9, 0.95, 1.0, 1.0];
        /// Color of the faces; alpha is its weight against the surface's color.
        paper: Color = [0.01, 0.012, 0.02, 1.0], when ("hidden", &["removed"]);
        /// Width of the lines.
        width_px: f32 = 1.5, hard 0.0..=256.0, soft 0.5..=8.0, unit "px";
        /// What becomes of lines behind faces.
        hidden: Hidden = Hidden::Removed as u32;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Wireframe>(
        "wireframe",
        "Wireframe",
        "draws the edges of triangles at a constant width",
    )
    .on_sample::<Wireframe>()
    .on_surface::<Wireframe>()
    .into()
});

impl SampleEffect for Wireframe {
    const HAS_SETUP: bool = true;

    /// How near the edge opposite each corner a sample must be, less one; 0 never. Each triangle
    /// draws half of a width.
    fn sample_setup(setup: &TriangleSetup, p: &Self, first: Option<u32>) -> [u32; 4] {
        let half_width = (f64::from(p.width_px) * 128.0).round_ties_even() as u64;
        let reach = |k: usize| match setup.outline >> k & 1 {
            0 => 0,
            _ => {
                ((setup.squared_length(k).isqrt() * half_width) >> setup.shift()).min(0x7fff_ffff)
                    as u32
                    + 1
            }
        };
        [first.unwrap_or(reach(0)), reach(1), reach(2), 0]
    }

    fn is_drawn(s: &Sample, p: &Self) -> bool {
        Hidden::of(p.hidden) == Hidden::Removed || (0..3).any(|k| s.areas[k] < s.setup[k])
    }
}

impl SurfaceEffect for Wireframe {
    const INPUTS: &[SurfaceInput] = &[SurfaceInput::EdgeDistance, SurfaceInput::Color];

    fn apply(mut s: Surface, p: &Self) -> Surface {
        let width = f64::from(p.width_px);
        // Where the faces are drawn too, the line ends softly, over one pixel.
        let line = match Hidden::of(p.hidden) {
            Hidden::Shown => 1.0,
            Hidden::Removed => {
                (0.5 * width + 0.5 - s.edge_distance_px.min_element()).clamp(0.0, 1.0)
            }
        };
        let (own, alpha) = (s.color.truncate(), s.color.w);
        let tinted = |[red, green, blue, weight]: [f32; 4]| {
            own.lerp([red, green, blue].map(f64::from).into(), weight.into())
        };
        s.color = tinted(p.paper).lerp(tinted(p.ink), line).extend(alpha);
        s
    }
}
