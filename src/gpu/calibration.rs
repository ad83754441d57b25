//! The calibration of an adapter: a few small pictures of built-in scenes, each with much of another kind of work, are timed, and the unit
//! costs that explain the times best are computed.

use std::{
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use super::{
    device::Gpu,
    error::RenderError,
    option_times::{best_limit, limit_pictures, option_costs, option_pictures},
    particles::Wait,
    renderer::{Renderer, Report},
    timer::Detail,
    warm_up::{self, FRAMES_PER_SAMPLE},
    workload::MovedSizes,
};
use crate::{
    accuracy::{Coverage, PinnedOptions, VertexTransform, Visibility},
    effects::{Effect, Stack},
    measure::timing,
    plan::{
        AccuracyRequest, Caps, Measured, Tuning,
        cost_model::{FrameWork, MeasuredWork, UnitCosts},
    },
    preset::{Preset, SceneSource},
    scene::{Scene, builtin, view::View},
};

/// Times of one picture, medians, milliseconds.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameTimes {
    /// The whole frame: by timestamps, or the time that passed on the CPU where the adapter has none.
    pub whole_ms: f64,
    /// Every pass by its label; empty without timestamps.
    pub passes: Vec<(String, f64)>,
    /// Frames that were timed as a whole.
    pub frames: usize,
}

/// What a calibration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibrated {
    pub costs: UnitCosts,
    /// Of options and limits, which the planner asks for.
    pub measured: Measured,
    /// Pictures that were timed.
    pub pictures: usize,
    /// Seconds in which frames were timed.
    pub measuring_s: f64,
    /// Seconds in which kernels were compiled and everything was made ready.
    pub preparing_s: f64,
}

/// An effect and the values that some of its parameters have instead of their defaults.
pub(super) type Enabled = (&'static str, &'static [(&'static str, f64)]);

/// A picture of the calibration: scene, effects and size in pixels.
pub(super) type Picture<'a> = (&'a str, &'static [Enabled], [u32; 2]);

/// Kinds of work that come together in one picture come in other proportions in another, so that the cost of each can be told.
const PICTURES: &[Picture<'static>] = &[
    ("sphere?triangles=200", &[("lambert", &[])], [16, 12]),
    ("sphere?triangles=20000", &[("wireframe", &[]), ("lambert", &[])], [160, 120]),
    ("sphere?triangles=320", &[("triangle_id", &[])], [60, 45]),
    ("sphere?triangles=1200", &[("race", &[])], [120, 90]),
    ("sphere?triangles=2000", &[("outline", &[]), ("fog", &[])], [320, 240]),
    ("teapot?tess=3", &[("outline", &[("width_px", 7.0)])], [80, 60]),
    ("teapot?tess=4", &[("hatch", &[]), ("normals", &[])], [120, 90]),
    ("stack?layers=24", &[("depth", &[])], [256, 256]),
    ("stack?layers=6", &[("overdraw", &[]), ("stipple", &[])], [120, 90]),
    ("near", &[("facet", &[])], [160, 120]),
    ("chamber", &[("shadow", &[])], [80, 60]),
    ("chamber", &[("toon", &[])], [96, 96]),
    ("panels", &[("toon", &[])], [120, 90]),
    ("panels", &[("smear", &[])], [40, 30]),
    ("globe?tess=6", &[("wireframe", &[])], [128, 96]),
    ("leaves?n=200", &[("dither", &[])], [160, 120]),
    ("tentacle?instances=6", &[("posterize", &[])], [96, 72]),
    ("tentacle?instances=60", &[("fog", &[])], [48, 36]),
    ("teapot?tess=6", &[("points", &[])], [120, 120]),
    ("teapot?tess=3", &[("points", &[("size_px", 20.0)])], [96, 72]),
    ("knot?tess=3", &[("dots", &[])], [160, 120]),
    ("teapot?tess=3", &[("dots", &[("spacing_m", 0.3), ("size_px", 8.0)])], [96, 72]),
    ("chamber", &[("particles", &[])], [120, 90]),
    ("teapot?tess=3", &[("particles", &[("count", 2000.0)])], [96, 72]),
    ("sphere?triangles=6000", &[("draw_order", &[])], [80, 60]),
    ("knot?tess=4", &[("xray", &[])], [120, 90]),
    ("cube-wall?columns=8&rows=6", &[("xray", &[]), ("lambert", &[])], [60, 45]),
    ("sphere?triangles=3000", &[("explode", &[]), ("stipple", &[])], [120, 90]),
    ("knot?tess=6", &[("wobble", &[]), ("triangle_id", &[])], [100, 75]),
    ("sphere?triangles=6000", &[("inflate", &[("amount_m", 8.0)])], [80, 60]),
    ("still-life?tess=1", &[("shadow", &[])], [96, 72]),
    ("cube-wall?columns=4&rows=3", &[("boxes", &[]), ("smear", &[])], [100, 80]),
    ("sphere?triangles=4000", &[("dissolve", &[])], [100, 75]),
    ("sphere?triangles=600", &[("dissolve", &[("mode", 3.0)])], [80, 60]),
    ("near", &[("lambert", &[])], [100, 75]),
    ("near", &[("depth", &[])], [40, 30]),
];

/// So many of the last pictures are drawn on the finest grid with strict vertices.
const FINE: usize = 2;

/// Frames of a picture that are drawn before any is timed.
const WARM_UP: usize = 2;
/// Frames that are timed, at least and at most; each is drawn once as a whole and once pass by pass.
const FRAMES: [usize; 2] = [3, 9];
/// Time for the frames of a picture beyond the least number of them.
const PICTURE_BUDGET: Duration = Duration::from_millis(40);

/// A picture of the calibration that is ready to be timed.
pub(super) struct Ready {
    renderer: Renderer,
    view: View,
    stack: Stack,
    accuracy: AccuracyRequest,
}

impl Ready {
    /// Compiles everything that the picture needs, with `tuning` instead of the adapter's usual one.
    ///
    /// # Errors
    /// When the picture cannot be drawn, or the device is lost.
    pub fn new(gpu: &Arc<Gpu>, picture: &Picture, accuracy: AccuracyRequest, tuning: Tuning) -> Result<Self, RenderError> {
        let (scene, view, stack) = made(picture);
        let mut renderer = Renderer::new(gpu.clone());
        renderer.set_tuning(tuning);
        renderer.set_scene(&scene)?;
        draw_until_ready(&mut renderer, &view, &stack, &accuracy)?;
        Ok(Self { renderer, view, stack, accuracy })
    }

    fn times(&mut self) -> Result<FrameTimes, RenderError> {
        timed(&mut self.renderer, &self.view, &self.stack, &self.accuracy)
    }

    /// Milliseconds of one whole frame.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn whole_ms(&mut self) -> Result<f64, RenderError> {
        let frames = if self.renderer.gpu().caps.software { 1 } else { FRAMES_PER_SAMPLE };
        let begin = Instant::now();
        let report = sample(&mut self.renderer, &self.view, &self.stack, &self.accuracy, Detail::Whole, frames)?;
        let passed_ms = begin.elapsed().as_secs_f64() * 1e3 / frames as f64;
        Ok(report.gpu_ms.filter(|ms| *ms > 0.0).unwrap_or(passed_ms))
    }
}

/// Times the pictures of the calibration on a device and computes the unit costs. `moved_sizes` samples their triangles; `progress` is told
/// the number of the next picture and of all.
///
/// # Errors
/// When a picture cannot be drawn, or the device is lost.
pub fn calibrate(gpu: &Arc<Gpu>, moved_sizes: MovedSizes, progress: &mut dyn FnMut(usize, usize)) -> Result<Calibrated, RenderError> {
    let begin = Instant::now();
    // An earlier calibration of the adapter counts for nothing.
    let usual = Caps { measured: None, ..gpu.caps }.tuning();
    // All kernels are compiled before anything is timed, so that a card stays at the clock of one at work.
    let mut ready = Vec::new();
    for (index, picture) in PICTURES.iter().enumerate() {
        progress(index, PICTURES.len());
        ready.push(Ready::new(gpu, picture, accuracy_of(index), usual)?);
    }
    let (options, limits) = (option_pictures(gpu, usual)?, limit_pictures(gpu, usual)?);
    let start = Instant::now();
    warm_up::warm_up(gpu, ready.len(), |at, frames| {
        let Ready { renderer, view, stack, accuracy } = &mut ready[at];
        sample(renderer, view, stack, accuracy, Detail::Whole, frames)?;
        Ok(true)
    })?;
    let is_software = gpu.caps.software;
    let passes_weight = PASSES_WEIGHT[usize::from(is_software)];
    let mut measured = Vec::new();
    for picture in &mut ready {
        let work = picture.renderer.work(&picture.stack, moved_sizes)?;
        measured.extend(observations(&work, &picture.times()?, passes_weight));
    }
    let planned = Measured { options: option_costs(options)?, max_small_samples: best_limit(limits)? };
    let (measuring_s, all_s) = (start.elapsed().as_secs_f64(), begin.elapsed().as_secs_f64());
    Ok(Calibrated {
        costs: UnitCosts::fitted(&measured, !is_software),
        measured: planned,
        pictures: PICTURES.len(),
        measuring_s,
        preparing_s: all_s - measuring_s,
    })
}

/// Every second picture finds depths first and triangles then, as all do where an adapter has no 64-bit atomics: it has other passes.
fn accuracy_of(index: usize) -> AccuracyRequest {
    let pins = if index % 2 == 1 { PinnedOptions::of(Visibility::Split32) } else { PinnedOptions::default() };
    let is_fine = index + FINE >= PICTURES.len();
    let pins = if is_fine { pins.with(Coverage::Fixed12).with(VertexTransform::Strict) } else { pins };
    AccuracyRequest { pins, ..AccuracyRequest::default() }
}

/// The scene, view and stack of a picture.
fn made((query, effects, size): &Picture) -> (Arc<Scene>, View, Stack) {
    let scene = Arc::new(builtin::build(query).expect("a built-in scene"));
    let mut preset = Preset { scene: SceneSource::Builtin((*query).to_owned()), ..Preset::default() };
    for (name, values) in *effects {
        let effect = Effect::find(name).expect("a built-in effect");
        let words = &mut preset.stack.enable(effect).words;
        for (field, value) in *values {
            let field = effect.field(field).expect("a parameter of the effect");
            field.set(words, &[*value]).expect("an allowed value");
        }
    }
    preset.clock.time_s = if preset.stack.has_steps() { 0.5 } else { 0.0 };
    let (view, stack) = preset.moments(&scene, *size).pop().expect("a preset has at least one frame");
    (scene, view, stack)
}

/// Draws until kernels are compiled and queues are large enough.
///
/// # Errors
/// When the picture cannot be drawn, or the device is lost.
pub fn draw_until_ready(renderer: &mut Renderer, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<(), RenderError> {
    let mut left = WARM_UP;
    // Queues grow a few times at most.
    for _ in 0..16 {
        renderer.draw_timed(view, stack, accuracy, Detail::Whole, Wait::Simulation)?;
        left -= usize::from(!renderer.finish()?.redraw);
        if left == 0 {
            break;
        }
    }
    Ok(())
}

/// Draws frames without a pause between them; the report is of the last.
fn sample(
    renderer: &mut Renderer,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
    detail: Detail,
    frames: usize,
) -> Result<Report, RenderError> {
    for _ in 0..frames {
        renderer.draw_timed(view, stack, accuracy, detail, Wait::Simulation)?;
    }
    renderer.finish()
}

/// Times a picture that was drawn before, on a card that has been kept busy first.
///
/// # Errors
/// When the picture cannot be drawn, or the device is lost.
pub fn time(renderer: &mut Renderer, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<FrameTimes, RenderError> {
    let gpu = renderer.gpu().clone();
    warm_up::warm_up(&gpu, 1, |_, frames| sample(renderer, view, stack, accuracy, Detail::Whole, frames).map(|_| true))?;
    timed(renderer, view, stack, accuracy)
}

/// Times a picture: as a whole and pass by pass in turn.
fn timed(renderer: &mut Renderer, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<FrameTimes, RenderError> {
    let has_timestamps = renderer.gpu().caps.timestamps;
    // On a software adapter a frame before the one that is timed would only take time.
    let frames = if renderer.gpu().caps.software { 1 } else { FRAMES_PER_SAMPLE };
    let (mut whole, mut passes): (Vec<f64>, Vec<(String, Vec<f64>)>) = (Vec::new(), Vec::new());
    let [least, most] = FRAMES;
    let begin = Instant::now();
    while whole.len() < least || whole.len() < most && begin.elapsed() < PICTURE_BUDGET {
        let start = Instant::now();
        let report = sample(renderer, view, stack, accuracy, Detail::Whole, frames)?;
        let passed_ms = start.elapsed().as_secs_f64() * 1e3 / frames as f64;
        // A stamp that was not written leaves no time.
        whole.extend(if has_timestamps { report.gpu_ms } else { Some(passed_ms) });
        if !has_timestamps {
            continue;
        }
        let mut seen = HashMap::new();
        for (label, ms) in sample(renderer, view, stack, accuracy, Detail::Passes, frames)?.passes {
            // A label may occur several times in a frame.
            let turn = seen.entry(label.clone()).and_modify(|turn| *turn += 1).or_insert(0usize);
            match passes.iter_mut().filter(|(known, _)| *known == label).nth(*turn) {
                Some((_, times)) => times.push(ms),
                None => passes.push((label, vec![ms])),
            }
        }
        if begin.elapsed() > 20 * PICTURE_BUDGET {
            break;
        }
    }
    let median = |times: &[f64]| timing::percentile(times, 0.5).unwrap_or(0.0);
    Ok(FrameTimes {
        whole_ms: median(&whole),
        frames: whole.len(),
        passes: passes.iter().map(|(label, times)| (label.clone(), median(times))).collect(),
    })
}

/// How much the passes of a frame count together beside the whole frame: on a card, where a pass that is timed alone overlaps with no other,
/// and on a CPU adapter.
const PASSES_WEIGHT: [f64; 2] = [0.2, 1.0];

/// Times beside the work that was done in them: the whole frame, and every pass in proportion to its part of the frame.
fn observations(work: &FrameWork, times: &FrameTimes, passes_weight: f64) -> Vec<MeasuredWork> {
    let mut measured = vec![MeasuredWork { counts: work.counts(), ms: times.whole_ms, weight: 1.0 }];
    let all: f64 = times.passes.iter().map(|(_, ms)| ms).sum();
    for (pass, ms) in paired(work, times) {
        measured.extend(ms.map(|ms| MeasuredWork { counts: pass.counts.clone(), ms, weight: passes_weight * (ms / all).max(0.02) }));
    }
    measured
}

/// Every pass of a frame with its measured milliseconds, where they are known.
pub fn paired<'a>(work: &'a FrameWork, times: &FrameTimes) -> Vec<(&'a crate::plan::cost_model::PassWork, Option<f64>)> {
    let mut left = times.passes.clone();
    let mut take = |label: &str| left.iter().position(|(name, _)| name == label).map(|at| left.remove(at).1);
    work.passes.iter().map(|pass| (pass, take(&pass.label))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::cost_model::{PassWork, Unit};

    #[test]
    fn every_picture_of_the_calibration_can_be_made() {
        for picture in PICTURES {
            let (scene, view, stack) = made(picture);
            assert!(scene.triangle_count() > 0 && view.pixels() > 0 && stack.check().is_ok(), "{picture:?}");
        }
    }

    #[test]
    fn passes_of_one_name_are_paired_in_their_order() {
        let pass = |label: &str, count: f64| PassWork { label: label.into(), counts: vec![(Unit::Pass, count)] };
        let work = FrameWork { passes: vec![pass("clear", 0.0), pass("args", 1.0), pass("clip", 2.0), pass("args", 3.0)] };
        let passes = [("clear", 0.1), ("args", 0.2), ("args", 0.4)].map(|(label, ms)| (label.to_owned(), ms)).to_vec();
        let times = FrameTimes { whole_ms: 1.0, passes, frames: 1 };
        let pairs: Vec<_> = paired(&work, &times).into_iter().map(|(pass, ms)| (pass.counts[0].1, ms)).collect();
        assert_eq!(pairs, [(0.0, Some(0.1)), (1.0, Some(0.2)), (2.0, None), (3.0, Some(0.4))]);
    }
}
