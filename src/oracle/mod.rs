//! The oracle: an exact CPU renderer that judges adapters and blesses goldens. It reads like a textbook and hurries nowhere.
//!
//! Coverage and ownership are decided in i64 and i128, at every pixel of a triangle's box afresh; projection, clipping,
//! depth and shading are f64. It shares scene bytes, matrix bits, effect parameters and plain data types with the
//! renderers it judges, and no line of their code: neither shader text nor planner, no SIMD maths where something is
//! decided, no platform maths function. Work is parallel by rows and triangles; no result depends on the order of threads.
//!
//! [`project_moved`] bends, moves and snaps vertices and clips triangles ([`project_strict`] in f32, to the bit),
//! [`triangles`] assembles and turns them, [`decide`] settles what sample effects hold against, [`cover_with`] finds who owns
//! each sample, [`shade`] colours it, and [`judge`] holds a frame that an adapter drew against all of that.

mod clip;
mod coverage;
mod decide;
mod deform;
mod dots;
mod faults;
mod finish;
pub mod flushed;
mod judge;
mod layers;
mod light;
mod mask;
mod moved;
mod order;
pub mod particles;
mod project;
mod rays;
mod rules;
mod shown;
mod spread;
mod steps;
mod strict;
mod surface;
mod texels;
mod whole;

pub use coverage::{Coverage, OrientedTriangle, Sample, cover, cover_with, depth_bound, owns, triangles};
pub use decide::decide;
pub use deform::volume;
pub use dots::{dot_records, dot_strengths};
pub use finish::{Seen, shade};
pub use judge::{judge, judge_after, snap_bounds};
pub use light::{shadow_errors, shadow_map};
pub use order::Cut;
pub use project::{project, project_moved};
pub use rules::SampleTests;
pub use shown::{references, render_scaled, scaled};
pub use strict::{project_strict, strict_frame};

use self::{
    finish::finish_all,
    layers::{Scenery, layered},
};
use crate::{
    effects::Stack,
    frame::{Counters, Frame, Geometry},
    math::{GUARD_BAND, SUBPIXEL_BITS},
    scene::{
        Scene,
        draw::{DrawError, draws},
        shadow_resolution::ShadowResolution,
        view::View,
    },
};

/// The true picture of `scene`, the first of its kind; empty when `view` has no pixels.
///
/// # Errors
/// When a placement or the number of triangles exceeds what the arithmetic holds.
pub fn render(scene: &Scene, view: &View, stack: &Stack) -> Result<Frame, DrawError> {
    render_next(scene, view, stack, None)
}

/// Most bits of the fraction with which every pixel of `view` lies inside the guard band, at most 12: the finest grid on
/// which the oracle draws it.
pub fn finest_bits(view: &View) -> u32 {
    let side = i64::from(view.width.max(view.height)).max(1);
    (SUBPIXEL_BITS..=12).rev().find(|bits| side << bits <= i64::from(GUARD_BAND)).unwrap_or(SUBPIXEL_BITS)
}

/// The true picture on the finest grid that holds it, with the eye taken out before any rounding: what snapping to a coarser
/// grid and rounding places are measured against.
///
/// # Errors
/// As [`render`].
pub fn render_finest(scene: &Scene, view: &View, stack: &Stack) -> Result<Frame, DrawError> {
    render(scene, &finest(view, stack), stack)
}

/// Where the corners of that picture lie.
///
/// # Errors
/// As [`render`].
pub fn project_finest(scene: &Scene, view: &View, stack: &Stack) -> Result<Geometry, DrawError> {
    let view = finest(view, stack);
    Ok(project_moved(scene, &draws(scene, &view)?, &view, stack))
}

fn finest(view: &View, stack: &Stack) -> View {
    // Sample effects measure triangles in 1/256 px.
    let is_measured = stack.each(|hooks| hooks.sample).next().is_some() || stack.point_radius() > 0;
    let subpixel_bits = if is_measured { SUBPIXEL_BITS } else { finest_bits(view) };
    view.with_grid(subpixel_bits, true)
}

/// The same, with the light that arrives told by rays: what shadow maps are measured against. Where effects leave samples
/// out, of which rays know nothing, the map of `view` tells it.
///
/// # Errors
/// As [`render`].
pub fn render_reference(scene: &Scene, view: &View, stack: &Stack) -> Result<Frame, DrawError> {
    render_finest(scene, &traced(view, stack), stack)
}

fn traced(view: &View, stack: &Stack) -> View {
    let has_rays = stack.light().is_some() && !light::leaves_out(stack);
    view.with_shadow(if has_rays { ShadowResolution::TRACED } else { view.precision.shadow })
}

/// The true picture of `scene` that follows `previous`, a picture of the same size.
///
/// # Errors
/// As [`render`].
pub fn render_next(scene: &Scene, view: &View, stack: &Stack, previous: Option<&[[u8; 4]]>) -> Result<Frame, DrawError> {
    if view.pixels() == 0 {
        draws(scene, view)?;
        return Ok(empty(view));
    }
    let scene = &*particles::dressed(scene, view, stack, None);
    let draws = draws(scene, view)?;
    let mut geometry = project_moved(scene, &draws, view, stack);
    geometry.sample_setups = decide(scene, &draws, view, stack, &geometry);
    geometry.dots = dot_records(scene, &draws, view, stack)?;
    geometry.light = shadow_map(scene, view, stack)?;
    let (triangles, counters) = triangles(scene, &draws, &geometry);
    let rules = SampleTests::of(stack, &geometry).masked(scene, &draws, stack).ordered(stack, &triangles, view);
    let coverage = cover_with(&rules, &triangles, view, None);
    let (triangle_ids, keys) = (&coverage.triangle_ids(), &coverage.keys());
    let dots = dot_strengths(view, stack, &geometry.dots, keys);
    let seen = Seen { triangle_ids, keys, dots: &dots, previous };
    let scenery = Scenery { scene, draws: &draws, view, geometry: &geometry, rules: &rules, triangles: &triangles, triangle_ids, keys };
    let (color, counted) = match layered(&scenery, &coverage, stack) {
        Some(layered) => (finish_all(&draws, view, stack, &seen, &layered.colors, 0.0), layered.counted),
        None => (shade(scene, &draws, view, stack, &seen, &geometry), Vec::new()),
    };
    Ok(Frame { dots, ..frame(view, &coverage, color, counted, counters) })
}

/// The true picture of the last of `moments`, drawn after those before it, all of one size.
///
/// # Errors
/// As [`render`].
///
/// # Panics
/// Without a moment.
pub fn render_sequence(scene: &Scene, moments: &[(View, Stack)]) -> Result<Frame, DrawError> {
    let mut last: Option<Frame> = None;
    for (view, stack) in moments {
        last = Some(render_next(scene, view, stack, last.as_ref().map(|frame| frame.color.as_slice()))?);
    }
    Ok(last.expect("a picture shows a moment"))
}

/// The picture of a view without pixels: nothing was drawn, so nothing was counted.
fn empty(view: &View) -> Frame {
    Frame { width: view.width, height: view.height, ..Default::default() }
}

/// The integers of `coverage` with their colours.
fn frame(view: &View, coverage: &Coverage, color: Vec<[u8; 4]>, counted: Vec<u32>, counters: Counters) -> Frame {
    let (triangle_id, key) = (coverage.triangle_ids(), coverage.keys());
    Frame { width: view.width, height: view.height, triangle_id, key, color, counted, counters, ..Frame::default() }
}
