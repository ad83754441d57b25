//! The trade: milliseconds beside error for every combination of options on chosen axes, interleaved in one run on one adapter.

use std::{collections::HashSet, sync::Arc};

use super::{capture::Capture, device::Gpu, error::RenderError, particles::Wait, renderer::Renderer, timer::Detail};
use crate::{
    accuracy::{AXES, Axis, AxisOption, PinnedOptions, RenderScale},
    effects::Stack,
    frame::{CullingStats, Frame, Geometry, NO_TRIANGLE, SnappedVertex},
    measure::{References, ShadowErrors, Verdict, compare, timing},
    plan::AccuracyRequest,
    preset::Preset,
    scene::{Scene, view::View},
};

/// What to measure.
#[derive(Clone, Debug)]
pub struct TradeOptions {
    pub size: [u32; 2],
    /// Timed frames per combination.
    pub samples: usize,
    /// Axes to walk; the others stay where the preset has them.
    pub axes: Vec<&'static Axis>,
    /// Every option alone beside the preset as it is planned, instead of every combination.
    pub is_one_option_at_a_time: bool,
}

/// Error of a combination. None reads "not measured", never 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct TradeError {
    /// Pixels with another triangle id than in the oracle's picture on its finest grid, per million of those drawn.
    pub wrong_ppm: f64,
    /// Samples that a triangle covers, given its snapped corners, and that were not drawn, per million pixels.
    pub holes_per_mpx: f64,
    /// Samples drawn more often than they are covered, per million pixels.
    pub double_hits_per_mpx: f64,
    /// Pixels whose triangle id covers them but is not the nearest, per million.
    pub wrong_depth_ppm: f64,
    /// Largest difference of a color channel from the oracle's picture, of 255; where sizes are compared, from its picture of
    /// eight by eight samples to a pixel.
    pub max_color_delta: u8,
    pub rms_color_delta: f64,
    /// Of the pixels that face the light, those where the shadow map errs by more than half of it, per million; none without
    /// a light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrong_light_ppm: Option<f64>,
    /// Root mean square of the share of the light by which the map errs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_light: Option<f64>,
    /// Pixels that differ between two equal frames.
    pub changed_pixels: u64,
    /// Furthest that a corner in the picture lies from where it is on the oracle's finest grid, pixels.
    pub moved_px: f64,
    /// Pixels that were left empty well inside what the oracle's picture covers, per million: cracks between neighbors.
    pub cracks_per_mpx: f64,
    pub overflow: u64,
    pub depth_without_id: u64,
    /// Largest distance of a particle from its true flight, pixels; none without particles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_divergence_px: Option<f64>,
    /// Mean of that in the scene, meters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_divergence_m: Option<f64>,
}

/// One combination of options.
#[derive(Clone, Debug, serde::Serialize)]
pub struct TradeRow {
    pub scene: String,
    pub triangles: u64,
    pub adapter: String,
    pub size: [u32; 2],
    /// `coverage=fixed8 depth=log16`, the chosen axes alone.
    pub options: String,
    #[serde(skip)]
    pub pins: PinnedOptions,
    /// Whole frame by timestamps, and what the CPU chose before it by the clock; none without timestamps or where the
    /// combination cannot be drawn.
    pub ms_p50: Option<f64>,
    pub ms_p95: Option<f64>,
    /// What the CPU alone took of that, where it had to choose anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpu_ms_p50: Option<f64>,
    /// Valid samples.
    pub samples: usize,
    /// Samples whose timestamps were impossible.
    pub invalid: usize,
    /// Samples far from the median (more than 5 MAD); they are kept.
    pub outliers: usize,
    pub error: Option<TradeError>,
    /// Buffers of the frame.
    pub bytes: u64,
    /// Another row is at least as right and at least as quick.
    pub is_dominated: bool,
    /// Meshlets that culling left and left out in the last picture.
    pub culled: Option<CullingStats>,
    /// Why it could not be drawn, what beats it, or what it spared.
    pub note: Option<String>,
}

/// What pictures are held against: the oracle's, which this module never sees.
pub struct Reference<'a> {
    /// Pictures on the oracle's finest grid, at every size of [`factors`], their shadows by rays.
    pub references: &'a References,
    pub judge: &'a dyn Fn(&View, &Stack, &Capture) -> Judged,
}

/// What the oracle says of a picture, and of the light in it where an effect asks for one.
pub struct Judged {
    pub verdict: Verdict,
    pub light: Option<ShadowErrors>,
}

/// How many pixels to a side of a shown one the combinations on these axes draw, one first.
pub fn factors(preset: &Preset, axes: &[&'static Axis]) -> Vec<f64> {
    let pinned = preset.accuracy.scale();
    let is_walked = axes.iter().any(|axis| axis.index() == RenderScale::AXIS);
    let drawn = RenderScale::ALL.iter().filter(|option| **option != RenderScale::Full && (is_walked || **option == pinned));
    std::iter::once(1.0).chain(drawn.map(|option| option.factor())).collect()
}

/// A combination with what has been measured of it.
struct Entry {
    pins: PinnedOptions,
    view: View,
    renderer: Renderer,
    error: TradeError,
    /// Triangles that own a pixel.
    triangle_ids: usize,
    bytes: u64,
    ms: Vec<f64>,
    cpu_ms: Vec<f64>,
    invalid: usize,
}

/// Measures every combination of options on the chosen axes, held against `reference`. `progress` gets what is going
/// on, steps done and all steps, and answers whether to go on; stopped early, what has been timed so far is returned.
///
/// # Errors
/// When the device is lost or the scene does not fit. What a combination cannot draw becomes its row's note.
pub fn trade(
    gpu: &Arc<Gpu>,
    preset: &Preset,
    scene: &Arc<Scene>,
    scene_name: &str,
    options: &TradeOptions,
    reference: &Reference,
    progress: &mut dyn FnMut(&str, usize, usize) -> bool,
) -> Result<Vec<TradeRow>, RenderError> {
    const WARM_UP: usize = 3;
    let pins = preset.accuracy.pins;
    let combinations = if options.is_one_option_at_a_time { each_alone(pins, &options.axes) } else { combinations(pins, &options.axes) };
    let rounds = options.samples + WARM_UP;
    let steps = combinations.len() * (1 + rounds);
    let (mut entries, mut lacking) = (Vec::new(), Vec::new());
    let mut is_wanted = true;
    for (i, &pins) in combinations.iter().enumerate() {
        is_wanted = is_wanted && progress(&words(&pins, &options.axes), i * (1 + rounds), steps);
        if !is_wanted {
            break;
        }
        // A option of the joints is settled with the pose that the view holds.
        let pinned = Preset { accuracy: AccuracyRequest { pins, ..preset.accuracy }, ..preset.clone() };
        match Entry::new(gpu, preset, scene, pinned.view(scene, options.size), pins, reference) {
            Ok(entry) => entries.push(entry),
            Err(error) if error.is_unsupported() => lacking.push((pins, error.to_string())),
            Err(error) => return Err(error),
        }
    }
    for round in 0..rounds {
        for entry in &mut entries {
            is_wanted = is_wanted && progress(&words(&entry.pins, &options.axes), combinations.len() * (1 + round), steps);
            if !is_wanted {
                break;
            }
            entry.sample(preset, round >= WARM_UP)?;
        }
    }
    let row = |pins: PinnedOptions| TradeRow {
        scene: scene_name.into(),
        triangles: scene.triangle_count(),
        adapter: gpu.summary.name.clone(),
        size: options.size,
        options: words(&pins, &options.axes),
        pins,
        ms_p50: None,
        ms_p95: None,
        cpu_ms_p50: None,
        samples: 0,
        invalid: 0,
        outliers: 0,
        error: None,
        bytes: 0,
        is_dominated: false,
        culled: None,
        note: None,
    };
    let mut rows: Vec<TradeRow> = entries.into_iter().map(|entry| entry.finish(&row)).collect();
    mark_dominated(&mut rows);
    rows.extend(lacking.into_iter().map(|(pins, why)| TradeRow { note: Some(why), ..row(pins) }));
    Ok(rows)
}

/// Every combination of options on `axes`, the first axis changing slowest.
fn combinations(pins: PinnedOptions, axes: &[&'static Axis]) -> Vec<PinnedOptions> {
    axes.iter().fold(vec![pins], |all, axis| {
        let with = |pins: &PinnedOptions, place: usize| {
            let mut pins = *pins;
            pins.set(axis, Some(place));
            pins
        };
        all.iter().flat_map(|pins| (0..axis.words.len()).map(move |place| with(pins, place))).collect()
    })
}

/// The preset as it is planned, then every option of every axis alone.
fn each_alone(pins: PinnedOptions, axes: &[&'static Axis]) -> Vec<PinnedOptions> {
    let options = axes.iter().flat_map(|axis| combinations(pins, &[*axis]));
    std::iter::once(pins).chain(options).collect()
}

/// What the combination for which nothing is pinned is called.
pub const AS_PLANNED: &str = "as planned";

/// The options of a combination on the chosen axes.
fn words(pins: &PinnedOptions, axes: &[&'static Axis]) -> String {
    let mut chosen = PinnedOptions::default();
    axes.iter().for_each(|axis| chosen.set(axis, pins.get(axis)));
    if AXES.iter().all(|axis| chosen.get(axis).is_none()) { AS_PLANNED.into() } else { chosen.words() }
}

impl Entry {
    /// Draws twice and measures the error.
    fn new(
        gpu: &Arc<Gpu>,
        preset: &Preset,
        scene: &Arc<Scene>,
        view: View,
        pins: PinnedOptions,
        reference: &Reference,
    ) -> Result<Self, RenderError> {
        let mut renderer = Renderer::new(gpu.clone());
        renderer.set_scene(scene)?;
        let accuracy = AccuracyRequest { pins, ..preset.accuracy };
        let first = renderer.capture(&view, &preset.stack, &accuracy)?;
        let second = renderer.capture(&view, &preset.stack, &accuracy)?;
        let bytes = renderer.explain().buffers.iter().map(|buffer| buffer.bytes).sum();
        let error = TradeError::of(&first, &second.frame, &(reference.judge)(&view, &preset.stack, &first), reference);
        let triangle_ids = first.frame.triangle_id.iter().filter(|triangle_id| **triangle_id != NO_TRIANGLE).collect::<HashSet<_>>().len();
        Ok(Self { pins, view, renderer, error, triangle_ids, bytes, ms: Vec::new(), cpu_ms: Vec::new(), invalid: 0 })
    }

    /// Draws twice without a pause and waits for the second: an idle device lowers its clocks, and others' frames empty its caches.
    fn sample(&mut self, preset: &Preset, is_kept: bool) -> Result<(), RenderError> {
        let accuracy = AccuracyRequest { pins: self.pins, ..preset.accuracy };
        self.renderer.draw_timed(&self.view, &preset.stack, &accuracy, Detail::Whole, Wait::Simulation)?;
        self.renderer.draw_timed(&self.view, &preset.stack, &accuracy, Detail::Whole, Wait::Simulation)?;
        let report = self.renderer.finish()?;
        match report.gpu_ms {
            Some(ms) if is_kept => {
                self.ms.push(ms + report.cpu_ms.unwrap_or(0.0));
                self.cpu_ms.extend(report.cpu_ms);
            }
            None if is_kept => self.invalid += 1,
            _ => {}
        }
        Ok(())
    }

    /// What culling spared, and the work that it left in vain.
    fn wasted(&self, culled: &CullingStats) -> String {
        let (drawn, all, meshlet_visibility) = (culled.drawn, culled.all(), self.triangle_ids);
        format!("{drawn} of {all} meshlets drawn ({}); {meshlet_visibility} triangles own a pixel", culled.reasons())
    }

    fn finish(self, row: &dyn Fn(PinnedOptions) -> TradeRow) -> TradeRow {
        TradeRow {
            ms_p50: timing::percentile(&self.ms, 0.5),
            ms_p95: timing::percentile(&self.ms, 0.95),
            cpu_ms_p50: timing::percentile(&self.cpu_ms, 0.5),
            samples: self.ms.len(),
            invalid: self.invalid,
            outliers: timing::outliers(&self.ms),
            error: Some(self.error),
            bytes: self.bytes,
            culled: self.renderer.culled(),
            note: self.renderer.culled().map(|culled| self.wasted(&culled)),
            ..row(self.pins)
        }
    }
}

impl TradeError {
    fn of(capture: &Capture, again: &Frame, judged: &Judged, reference: &Reference) -> Self {
        let (frame, scale) = (&capture.frame, capture.geometry.scale);
        let (picture, corners) = reference.references.at(scale).expect("a reference at every size that is drawn");
        let pixels = (frame.triangle_id.len() as f64).max(1.0);
        let per_million = |count: u64| count as f64 * 1e6 / pixels;
        // Where sizes are compared, colors are held against many samples a pixel, else against the true picture's.
        let shown = capture.shown.as_ref().unwrap_or(frame);
        let colors = match &reference.references.smooth {
            Some(smooth) => compare::pictures(&shown.color, smooth, 0),
            None => compare::pictures(&frame.color, &picture.color, 0),
        };
        let differs = |i: &usize| frame.triangle_id[*i] != again.triangle_id[*i] || frame.color[*i] != again.color[*i];
        let a = &judged.verdict.report;
        let moved_px = moved_px(&capture.geometry, corners, [frame.width, frame.height]);
        Self {
            wrong_ppm: per_million(compare::triangle_ids(&frame.triangle_id, &picture.triangle_id).different),
            holes_per_mpx: per_million(a.holes),
            double_hits_per_mpx: per_million(a.double_hits),
            wrong_depth_ppm: per_million(a.wrong_nearest),
            max_color_delta: colors.max_delta,
            rms_color_delta: colors.rms,
            wrong_light_ppm: judged.light.map(|light| light.wrong as f64 * 1e6 / (light.pixels as f64).max(1.0)),
            rms_light: judged.light.map(|light| light.rms),
            changed_pixels: (0..frame.triangle_id.len()).filter(differs).count() as u64,
            moved_px: moved_px / scale,
            cracks_per_mpx: per_million(cracks(frame, picture, moved_px)),
            overflow: a.overflow,
            depth_without_id: a.depth_without_id,
            max_divergence_px: (a.particles > 0).then_some(a.max_divergence_px),
            mean_divergence_m: (a.particles > 0).then_some(a.mean_divergence_m),
        }
    }

    /// Is nothing of it larger than in `other`?
    pub fn is_at_most(&self, other: &Self) -> bool {
        let stats = |e: &Self| {
            let sample_counts = [e.changed_pixels, e.overflow, e.depth_without_id].map(|count| count as f64);
            let shares = [
                e.wrong_ppm,
                e.holes_per_mpx,
                e.double_hits_per_mpx,
                e.wrong_depth_ppm,
                e.rms_color_delta,
                e.cracks_per_mpx,
                e.mean_divergence_m.unwrap_or(0.0),
            ];
            let light = [e.wrong_light_ppm, e.rms_light].map(Option::unwrap_or_default);
            [shares.to_vec(), light.to_vec(), sample_counts.to_vec(), vec![e.max_color_delta.into()]].concat()
        };
        stats(self).iter().zip(stats(other)).all(|(a, b)| *a <= b)
    }
}

/// Furthest that a corner of `given` lies from its twin, of those that are in the picture; either has a grid of its own.
fn moved_px(given: &Geometry, reference: &Geometry, size: [u32; 2]) -> f64 {
    let place = |geometry: &Geometry, at: &SnappedVertex| [at.x, at.y].map(|v| f64::from(v) / f64::from(1 << geometry.subpixel_bits));
    let distance = |(a, b): (&SnappedVertex, &SnappedVertex)| {
        let ([ax, ay], [bx, by]) = (place(given, a), place(reference, b));
        let is_seen = a.flags == 0 && b.flags == 0 && (0.0..=size[0].into()).contains(&bx) && (0.0..=size[1].into()).contains(&by);
        if is_seen { libm::hypot(ax - bx, ay - by) } else { 0.0 }
    };
    given.vertices.iter().zip(&reference.vertices).map(distance).fold(0.0, f64::max)
}

/// Pixels that are empty although the true picture covers them and everything as near as an outline may have moved.
fn cracks(frame: &Frame, reference: &Frame, moved_px: f64) -> u64 {
    let [width, height] = [frame.width, frame.height].map(i64::from);
    let reach = 1 + (moved_px.ceil() as i64).clamp(0, 15);
    let is_inside = |pixel: usize| {
        let (x, y) = (pixel as i64 % width, pixel as i64 / width);
        let rows = (y - reach).max(0)..=(y + reach).min(height - 1);
        let mut around = rows.flat_map(|y| ((x - reach).max(0)..=(x + reach).min(width - 1)).map(move |x| (y * width + x) as usize));
        around.all(|at| reference.triangle_id[at] != NO_TRIANGLE)
    };
    (0..frame.triangle_id.len())
        .filter(|&pixel| frame.triangle_id[pixel] == NO_TRIANGLE && reference.triangle_id[pixel] != NO_TRIANGLE && is_inside(pixel))
        .count() as u64
}

/// Marks rows that another row makes pointless: as right or better, and quicker, or as quick and better.
fn mark_dominated(rows: &mut [TradeRow]) {
    let beats = |a: &TradeRow, b: &TradeRow| {
        let (Some(ea), Some(eb), Some(ta), Some(tb)) = (a.error, b.error, a.ms_p50, b.ms_p50) else { return false };
        ea.is_at_most(&eb) && ta <= tb && (ta < tb || !eb.is_at_most(&ea))
    };
    let dominated: Vec<Option<String>> = rows
        .iter()
        .map(|row| {
            let better = rows.iter().filter(|other| beats(other, row));
            better.min_by(|a, b| a.ms_p50.unwrap_or(f64::MAX).total_cmp(&b.ms_p50.unwrap_or(f64::MAX))).map(|other| other.options.clone())
        })
        .collect();
    for (row, better) in rows.iter_mut().zip(dominated) {
        row.is_dominated = better.is_some();
        let dominated = better.map(|better| format!("no gain: {better} is as right and not slower"));
        row.note = [row.note.take(), dominated].into_iter().flatten().reduce(|a, b| format!("{a}; {b}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::{Coverage, DepthFormat};

    #[test]
    fn combinations_are_the_product_and_keep_other_pins() {
        let axes = [&AXES[Coverage::AXIS], &AXES[DepthFormat::AXIS]];
        let all = combinations(PinnedOptions::of(crate::accuracy::Visibility::Split32), &axes);
        assert_eq!(all.len(), Coverage::ALL.len() * DepthFormat::ALL.len());
        assert!(all.iter().all(|pins| pins.option() == Some(crate::accuracy::Visibility::Split32)));
        assert_eq!(words(&all[0], &axes), format!("coverage={} depth={}", Coverage::ALL[0].name(), DepthFormat::ALL[0].name()));
    }

    #[test]
    fn a_row_is_beaten_only_by_one_that_is_nowhere_worse() {
        let row = |ms: f64, wrong_ppm: f64| TradeRow {
            scene: String::new(),
            triangles: 0,
            adapter: String::new(),
            size: [1, 1],
            options: format!("{ms}"),
            pins: PinnedOptions::default(),
            ms_p50: Some(ms),
            ms_p95: Some(ms),
            cpu_ms_p50: None,
            samples: 1,
            invalid: 0,
            outliers: 0,
            error: Some(TradeError { wrong_ppm, ..TradeError::default() }),
            bytes: 0,
            is_dominated: false,
            culled: None,
            note: None,
        };
        let mut rows = [row(1.0, 5.0), row(2.0, 1.0), row(3.0, 1.0), row(3.0, 0.0)];
        mark_dominated(&mut rows);
        assert_eq!(rows.map(|row| row.is_dominated), [false, false, true, false]);
    }
}
