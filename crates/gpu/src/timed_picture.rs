//! Pictures that are timed: as a whole and pass by pass, once their kernels are compiled.

use std::{
    collections::HashMap,
    sync::Arc,
    time::{Duration, Instant},
};

use super::{
    device::Gpu,
    error::RenderError,
    particles::Wait,
    renderer::{Renderer, Report},
    timer::Detail,
    warm_up::{self, FRAMES_PER_SAMPLE},
    workload::MovedSizes,
};
use crate::{
    effects::{Effect, Stack},
    measure::timing,
    plan::{AccuracyRequest, Tuning, cost_model::FrameWork},
    preset::{Preset, SceneSource},
    scene::{Scene, builtin, view::View},
};

/// Times of one picture, milliseconds: medians, and on a CPU adapter the shortest, since other work on the machine only makes frames longer.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameTimes {
    /// The whole frame: by timestamps, or the time that passed on the CPU where the adapter has none; above 0.
    pub whole_ms: f64,
    /// Every pass by its label; empty without timestamps.
    pub passes: Vec<(String, f64)>,
    /// Frames that were timed as a whole.
    pub frames: usize,
}

/// An effect and the values that some of its parameters have instead of their defaults.
pub type Enabled = (&'static str, &'static [(&'static str, f64)]);

/// A picture: built-in scene, effects and size in pixels.
pub type Picture<'a> = (&'a str, &'static [Enabled], [u32; 2]);

/// Frames of a picture that are drawn before any is timed.
const FIRST_FRAMES: usize = 2;
/// Frames that are timed, at least and at most; each is drawn once as a whole and once pass by pass.
const FRAMES: [usize; 2] = [3, 7];
/// Time for the frames of a picture beyond the least number of them.
const PICTURE_BUDGET: Duration = Duration::from_millis(40);

/// A picture that is ready to be timed.
pub struct TimedPicture {
    renderer: Renderer,
    view: View,
    stack: Stack,
    accuracy: AccuracyRequest,
}

impl TimedPicture {
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

    /// What its last frame had to do.
    ///
    /// # Errors
    /// When nothing was drawn.
    pub fn work(&self, moved_sizes: MovedSizes) -> Result<FrameWork, RenderError> {
        self.renderer.work(&self.stack, moved_sizes)
    }

    /// Draws frames without a pause between them, and waits for them.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn draw(&mut self, frames: usize) -> Result<(), RenderError> {
        sample(&mut self.renderer, &self.view, &self.stack, &self.accuracy, Detail::Whole, frames).map(|_| ())
    }

    /// Times it as a whole and pass by pass in turn.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn times(&mut self) -> Result<FrameTimes, RenderError> {
        timed(&mut self.renderer, &self.view, &self.stack, &self.accuracy)
    }

    /// Milliseconds of one whole frame; none where the adapter has not written its timestamps.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn whole_ms(&mut self) -> Result<Option<f64>, RenderError> {
        whole_ms(&mut self.renderer, &self.view, &self.stack, &self.accuracy)
    }
}

/// The scene, view and stack of a picture.
pub fn made((query, effects, size): &Picture) -> (Arc<Scene>, View, Stack) {
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
    let mut left = FIRST_FRAMES;
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

/// Frames that are drawn for one time. On a software adapter a frame before the one that is timed would only take time.
fn frames_per_sample(renderer: &Renderer) -> usize {
    if renderer.gpu().caps.software { 1 } else { FRAMES_PER_SAMPLE }
}

/// Milliseconds of one whole frame, above 0: by timestamps, or the time that passed on the CPU where the adapter has none.
fn whole_ms(renderer: &mut Renderer, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<Option<f64>, RenderError> {
    let frames = frames_per_sample(renderer);
    let begin = Instant::now();
    let report = sample(renderer, view, stack, accuracy, Detail::Whole, frames)?;
    let passed_ms = begin.elapsed().as_secs_f64() * 1e3 / frames as f64;
    let ms = if renderer.gpu().caps.timestamps { report.gpu_ms } else { Some(passed_ms) };
    Ok(ms.filter(|ms| *ms > 0.0))
}

/// Times a picture that was drawn before, on a card that has been kept busy first.
///
/// # Errors
/// When the picture cannot be drawn, the adapter writes no timestamps, or the device is lost.
pub fn time(renderer: &mut Renderer, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<FrameTimes, RenderError> {
    let gpu = renderer.gpu().clone();
    warm_up::warm_up(&gpu, warm_up::FROM_IDLE, 1, |_, frames| {
        sample(renderer, view, stack, accuracy, Detail::Whole, frames).map(|_| true)
    })?;
    timed(renderer, view, stack, accuracy)
}

/// Times a picture: as a whole and pass by pass in turn.
fn timed(renderer: &mut Renderer, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<FrameTimes, RenderError> {
    let has_timestamps = renderer.gpu().caps.timestamps;
    let frames = frames_per_sample(renderer);
    let (mut whole, mut passes): (Vec<f64>, Vec<(String, Vec<f64>)>) = (Vec::new(), Vec::new());
    let [least, most] = FRAMES;
    let begin = Instant::now();
    while whole.len() < least || whole.len() < most && begin.elapsed() < PICTURE_BUDGET {
        whole.extend(whole_ms(renderer, view, stack, accuracy)?);
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
    let percentile = if renderer.gpu().caps.software { 0.0 } else { 0.5 };
    let typical = |times: &[f64]| timing::percentile(times, percentile).unwrap_or(0.0);
    if whole.is_empty() {
        return Err(RenderError::NoTimestamps);
    }
    Ok(FrameTimes {
        whole_ms: typical(&whole),
        frames: whole.len(),
        passes: passes.iter().map(|(label, times)| (label.clone(), typical(times))).collect(),
    })
}
