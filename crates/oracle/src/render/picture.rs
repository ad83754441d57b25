//! Whole pictures: from a scene to a frame.

use std::ops::Range;

use super::{
    super::{
        budget::{self, Purpose},
        shot::Shot,
    },
    coverage::cover_with,
    dots::{dot_records, dot_strengths},
    draw_order::limited,
    layers::{LayerInput, layer_image},
    particles::{check_particles, scene_with_particles},
    passes::{PassStart, passed},
    project::project,
    resolve::{ResolveInput, finish, shade_rows},
    sample_rules::SampleTests,
    sample_setup::sample_setups,
    shadow::shadow_map,
    strict::project_strict,
    triangles::triangles,
    work_limits::check_samples,
};
use crate::{
    effects::Stack,
    frame::{Earlier, Frame, Geometry},
    scene::{Scene, draw::DrawError, view::View},
};

/// The exact picture of `scene`, the first of its sequence; empty if `view` has no pixels.
pub fn render(scene: &Scene, view: &View, stack: &Stack) -> Result<Frame, DrawError> {
    render_next(scene, view, stack, None)
}

/// The exact picture of `scene` that follows an `earlier` one of the same size.
pub fn render_next(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    earlier: Option<Earlier<'_>>,
) -> Result<Frame, DrawError> {
    render_rows(scene, view, stack, earlier, 0..view.height)
}

/// The same, with the colors of `rows` alone, the bytes that the whole picture has there. All else
/// is that of the whole picture. So several processes share the shading of a picture; layers are
/// drawn whole by each of them.
pub fn render_rows(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    earlier: Option<Earlier<'_>>,
    rows: Range<u32>,
) -> Result<Frame, DrawError> {
    drawn(scene, view, stack, earlier, rows).map(|(frame, _)| frame)
}

/// The picture of [`render_next`] and what it was drawn from: vertices, what clipping made, setups
/// of sample effects, dots and the shadow map; both empty if `view` has no pixels.
pub fn render_with_geometry(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    earlier: Option<Earlier<'_>>,
) -> Result<(Frame, Geometry), DrawError> {
    drawn(scene, view, stack, earlier, 0..view.height)
}

/// The picture with the colors of `rows` alone, and what it was drawn from.
fn drawn(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    earlier: Option<Earlier<'_>>,
    rows: Range<u32>,
) -> Result<(Frame, Geometry), DrawError> {
    let rows = rows.start.min(view.height)..rows.end.min(view.height);
    if view.pixels() == 0 {
        stack.draws(scene, view)?;
        let frame = Frame {
            width: view.width,
            height: view.height,
            ..Frame::default()
        };
        return Ok((frame, Geometry::default()));
    }
    check_particles(view, stack)?;
    let scene = &*scene_with_particles(scene, view, stack, None)?;
    let draws = stack.draws(scene, view)?;
    let shot = Shot::new(scene, &draws, view, stack);
    budget::check(&shot, Purpose::Draw)?;
    let mut geometry = project(&shot)?;
    geometry.sample_setups = sample_setups(&shot, &geometry);
    geometry.dots = dot_records(&shot)?;
    geometry.shadow_map = shadow_map(scene, view, stack)?;
    let (triangles, counters) = triangles(&shot, &geometry)?;
    let tests = SampleTests::new(&shot, &geometry);
    check_samples("picture", &triangles, &tests, view)?;
    let tests = limited(tests, stack, &triangles, view)?;
    let coverage = cover_with(&tests, &triangles, view)?;
    let (triangle_id, depth_key) = (coverage.triangle_ids(), coverage.depth_keys());
    let (triangle_ids, depth_keys) = (&*triangle_id, &*depth_key);
    let dots = dot_strengths(view, stack, &geometry.dots, depth_keys);
    let input = ResolveInput {
        triangle_ids,
        depth_keys,
        dots: &dots,
        previous: earlier.map(|earlier| earlier.resolved),
    };
    let layer_input = LayerInput {
        shot,
        geometry: &geometry,
        tests: &tests,
        triangles: &triangles,
        triangle_ids,
        depth_keys,
        glass: None,
    };
    // Passes read pixels of all rows.
    let has_passes = stack.has_passes();
    let asked = rows.clone();
    let rows = if has_passes { 0..view.height } else { rows };
    let (color, counted) = match layer_image(&layer_input, || coverage.layers())? {
        Some(image) => {
            let mut color = finish(&shot, &input, &image.colors, 0.0)?;
            let [first, end] = [rows.start, rows.end].map(|row| (row * view.width) as usize);
            color.truncate(end);
            (color.split_off(first.min(end)), image.counted)
        }
        None => (shade_rows(&shot, &input, &geometry, rows)?, Vec::new()),
    };
    let (color, resolved, kept) = if has_passes {
        let start = PassStart {
            resolved: &color,
            kept: earlier.map_or(&[], |earlier| earlier.kept),
        };
        let (passed, kept) = passed(&shot, &input, start, !asked.is_empty())?;
        let [first, end] = [asked.start, asked.end].map(|row| (row * view.width) as usize);
        (passed[first..end.max(first)].to_vec(), Some(color), kept)
    } else {
        (color, None, None)
    };
    let frame = Frame {
        width: view.width,
        height: view.height,
        triangle_id,
        depth_key,
        color,
        resolved,
        kept,
        layer_sums: counted,
        dots,
        counters,
        ..Frame::default()
    };
    Ok((frame, geometry))
}

/// The exact picture of the last of `sequence`, drawn after those before it, all of the same size.
///
/// # Panics
/// If `sequence` is empty.
pub fn render_sequence(scene: &Scene, sequence: &[(View, Stack)]) -> Result<Frame, DrawError> {
    let mut last: Option<Frame> = None;
    for (at, (view, stack)) in sequence.iter().enumerate() {
        // Earlier pictures of the sequence are not shown: only what their kept pass writes is read.
        let is_seen = at + 1 == sequence.len() || !stack.has_passes();
        let rows = 0..if is_seen { view.height } else { 0 };
        let earlier = last.as_ref().map(Frame::earlier);
        last = Some(render_rows(scene, view, stack, earlier, rows)?);
    }
    Ok(last.expect("a sequence has a picture"))
}

/// Triangle id and depth key of every pixel with strict vertices and integer keys, which every
/// adapter must match to the bit (`docs/exactness.md` §10); `stack` must move no vertices.
pub fn strict_frame(
    scene: &Scene,
    view: &View,
    stack: &Stack,
) -> Result<(Vec<u32>, Vec<u32>), DrawError> {
    let draws = stack.draws(scene, view)?;
    let shot = Shot::new(scene, &draws, view, stack);
    let mut geometry = project_strict(&shot);
    geometry.bit_exact.depth_keys = true;
    geometry.sample_setups = sample_setups(&shot, &geometry);
    let (triangles, _) = triangles(&shot, &geometry)?;
    let coverage = cover_with(
        &limited(SampleTests::new(&shot, &geometry), stack, &triangles, view)?,
        &triangles,
        view,
    )?;
    Ok((coverage.triangle_ids(), coverage.depth_keys()))
}
