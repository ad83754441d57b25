//! Screen: a picture in the window and the thread that draws it. It draws only when an input has
//! changed, and a few frames more at rest to measure them; after a failure the last good picture
//! stays.

use std::{sync::Arc, thread::JoinHandle};

use web_time::Instant;

pub use super::inputs::Inputs;
use super::{
    blit::{Blit, Blitter},
    picture_thread::{Drawn, Finished, Outcome, PictureThread},
    timings::{Sample, Subject, Timings},
};
use crate::{
    accuracy::AccuracyOptions,
    app::shell::{device::Devices, ending::EndingThreads, ui_frames::UiFrames},
    gpu::{Explanation, Gpu, Report},
    plan::Plan,
};

/// A picture in the window and the thread that draws it.
pub struct Screen {
    /// Draws the pictures.
    pub gpu: Arc<Gpu>,
    devices: Devices,
    ctx: egui::Context,
    thread: PictureThread,
    ending: Arc<EndingThreads>,
    blitter: Blitter,
    picture: Option<Picture>,
    /// The inputs that were requested last, at full size.
    requested: Option<Inputs>,
    divisor: u32,
    /// What the thread draws, or drew last; smaller than requested while it moves on a slow
    /// adapter.
    ordered: Option<Inputs>,
    /// The picture that was ordered is still to come.
    is_waiting: bool,
    /// When pictures were ordered that may still come, and the times that they show, seconds.
    times: Vec<(Instant, f64)>,
    /// The time that the newest picture shows, seconds.
    time_s: Option<f64>,
    /// It could not be drawn; it is not tried again until it changes.
    has_failed: bool,
    is_measuring: bool,
    /// What the newest picture was made from.
    drawn: Option<Inputs>,
    report: Option<Report>,
    options: Option<AccuracyOptions>,
    plan: Option<Arc<Plan>>,
    explanation: Option<Arc<Explanation>>,
    timings: Timings,
}

/// What the window shows.
struct Picture {
    blit: Blit,
    view: wgpu::TextureView,
    size: [u32; 2],
}

impl Screen {
    pub fn new(window: &egui_wgpu::RenderState, devices: Devices, ctx: egui::Context) -> Self {
        Self::with(devices, Blitter::new(window), ctx, Arc::default())
    }

    fn with(
        devices: Devices,
        blitter: Blitter,
        ctx: egui::Context,
        ending: Arc<EndingThreads>,
    ) -> Self {
        Self {
            thread: PictureThread::start(devices.clone(), ctx.clone(), ending.clone()),
            ending,
            gpu: devices.picture.clone(),
            devices,
            ctx,
            blitter,
            picture: None,
            requested: None,
            divisor: 1,
            ordered: None,
            is_waiting: false,
            times: Vec::new(),
            time_s: None,
            has_failed: false,
            is_measuring: false,
            drawn: None,
            report: None,
            options: None,
            plan: None,
            explanation: None,
            timings: Timings::default(),
        }
    }

    /// A second screen on the same device, for another picture in the same window.
    pub fn sibling(&self) -> Self {
        Self::with(
            self.devices.clone(),
            self.blitter.clone(),
            self.ctx.clone(),
            self.ending.clone(),
        )
    }

    /// Draws the next picture with the shaders as they are now, and again if the last one could not
    /// be drawn.
    pub fn reload_shaders(&mut self) {
        self.thread.reload_shaders();
        self.ordered = None;
        (self.is_waiting, self.has_failed, self.is_measuring) = (false, false, false);
    }

    /// The window waits for this thread when it closes, as for those that draw.
    pub fn wait_at_end(&self, thread: JoinHandle<()>) {
        self.ending.add(thread);
    }

    /// True if a device was lost. Asks the window's, since nothing else does while nothing is
    /// drawn.
    pub fn is_lost(&self) -> bool {
        let _ = self.devices.window.device.poll(wgpu::PollType::Poll);
        if !Arc::ptr_eq(&self.gpu, &self.devices.window) {
            // Asked here, the device could keep the window waiting.
            self.thread.check_device();
        }
        self.gpu.is_lost() || self.devices.window.is_lost()
    }

    /// The first error of a device that no scope caught, since the last call.
    pub fn take_error(&self) -> Option<String> {
        self.gpu
            .take_error()
            .or_else(|| self.devices.window.take_error())
    }

    /// Number of frames dispatched so far.
    pub fn draws(&self) -> u64 {
        self.thread.draws()
    }

    /// The newest picture and its size in pixels.
    pub fn picture(&self) -> Option<(&Blit, [u32; 2])> {
        self.picture
            .as_ref()
            .map(|picture| (&picture.blit, picture.size))
    }

    /// How the newest picture differs from another screen's, times `gain`.
    pub fn difference(&self, other: &Self, gain: u8) -> Option<Blit> {
        let views = [&self.picture.as_ref()?.view, &other.picture.as_ref()?.view];
        Some(
            self.blitter
                .difference(&self.devices.window.device, views, gain),
        )
    }

    /// The inputs that were requested last, at full size; none before the first.
    pub fn requested(&self) -> Option<&Inputs> {
        self.requested.as_ref()
    }

    /// What the newest picture was made from.
    pub fn drawn(&self) -> Option<&Inputs> {
        self.drawn.as_ref()
    }

    /// Times and counters of the newest frame whose inputs had changed.
    pub fn report(&self) -> Option<&Report> {
        self.report.as_ref()
    }

    /// The times of its frames.
    pub fn timings(&self) -> &Timings {
        &self.timings
    }

    /// The accuracy options of the newest picture's kernel.
    pub fn options(&self) -> Option<AccuracyOptions> {
        self.options
    }

    /// The plan of the newest picture.
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_deref()
    }

    /// What the newest picture ran, and why.
    pub fn explanation(&self) -> Option<&Explanation> {
        self.explanation.as_deref()
    }

    /// True if the requested picture was tried and could not be drawn.
    pub fn is_refused(&self) -> bool {
        self.has_failed
    }

    /// True while the requested picture is still to come.
    pub fn is_waiting(&self) -> bool {
        self.is_waiting
    }

    /// True while a picture is still to come that differs by more than its moment from the one that
    /// is shown. While a preset plays, the requested picture is always still to come.
    pub fn is_awaited(&self, is_playing: bool) -> bool {
        let is_shown = || {
            self.drawn
                .as_ref()
                .zip(self.ordered.as_ref())
                .is_some_and(|(drawn, ordered)| drawn.shares_kernels(ordered))
        };
        self.is_waiting && !(is_playing && is_shown())
    }

    /// True while the picture is drawn again to be measured.
    pub fn is_measuring(&self) -> bool {
        self.is_measuring
    }

    /// What is compiled for the requested picture, in words; none while nothing is.
    pub fn compiling(&self) -> Option<String> {
        let ordered = self
            .ordered
            .as_ref()
            .filter(|_| self.is_waiting && self.thread.is_compiling())?;
        let new = ordered.new_effects(self.drawn.as_ref());
        Some(match &new[..] {
            [] => "Compiling kernels…".into(),
            [one] => format!("Compiling {one}…"),
            [first @ .., last] => format!("Compiling {} and {last}…", first.join(", ")),
        })
    }

    /// Holds the thread when it is next about to compile, or lets it go on. For tests.
    pub fn hold_compiling(&self, is_held: bool) {
        self.thread.hold_compiling(is_held);
    }

    /// Width and height in pixels of the picture that was asked for last, reduced while it moves;
    /// none before the first.
    pub fn ordered_size(&self) -> Option<[u32; 2]> {
        self.ordered
            .as_ref()
            .map(|inputs| [inputs.view.width, inputs.view.height])
    }

    /// Full pixels per drawn pixel along a side; above 1 while the picture moves on a slow adapter.
    pub fn divisor(&self) -> u32 {
        self.divisor
    }

    /// The time that the newest picture shows, seconds.
    pub fn time_s(&self) -> Option<f64> {
        self.time_s
    }

    /// Has `requested`, the picture of `time_s`, drawn at its size over `divisor`, unless that is
    /// what the picture shows or what could not be drawn.
    pub fn show(&mut self, requested: Inputs, divisor: u32, time_s: f64) {
        let inputs = requested.reduced(divisor);
        (self.requested, self.divisor) = (Some(requested), divisor);
        if self.ordered.as_ref() == Some(&inputs) {
            if !self.is_waiting {
                self.time_s = Some(time_s); // The same picture at another time.
            }
            return;
        }
        (self.is_waiting, self.has_failed, self.is_measuring) = (true, false, false);
        self.timings.change();
        self.ordered = Some(inputs.clone());
        // The input that asks for it was there when the frame of the window began.
        let asked_at = self
            .ctx
            .with_plugin(|frames: &mut UiFrames| frames.begun())
            .flatten();
        let asked_at = asked_at.unwrap_or_else(Instant::now);
        self.times.push((asked_at, time_s));
        self.thread.draw(inputs, asked_at);
    }

    /// Forgets what was measured of another preset, or at another size.
    pub fn reset_timings(&mut self) {
        self.timings.reset();
    }

    /// True if the picture shows what was requested, at full size, and its cost is not known.
    pub fn needs_measuring(&self) -> bool {
        let is_drawn =
            self.requested.is_some() && self.drawn == self.requested && self.picture.is_some();
        is_drawn
            && !self.is_waiting
            && !self.has_failed
            && self.gpu.caps.timestamps
            && !self.timings.is_settled()
    }

    /// Has the picture drawn again until its cost is known, if that is needed.
    pub fn measure(&mut self) {
        if self.needs_measuring()
            && !self.is_measuring
            && let Some(drawn) = &self.drawn
        {
            self.thread.measure(drawn.clone());
            self.is_measuring = true;
        }
    }

    /// Takes what the thread has finished, without waiting.
    ///
    /// # Errors
    /// If the requested picture could not be drawn, in a sentence for people.
    pub fn poll(&mut self) -> Result<(), String> {
        let mut refused = Ok(());
        while let Some(Finished { inputs, outcome }) = self.thread.next() {
            let is_newest = self.ordered.as_ref() == Some(&inputs);
            match outcome {
                Outcome::Drawn(drawn, asked_at) => {
                    self.is_waiting &= !is_newest || drawn.is_partial;
                    if let Some((_, time_s)) = self.times.iter().rfind(|(at, _)| *at == asked_at) {
                        self.time_s = Some(*time_s);
                    }
                    self.times
                        .retain(|(at, _)| *at > asked_at || drawn.is_partial);
                    self.take(inputs, *drawn, asked_at.elapsed().as_secs_f64() * 1e3);
                }
                Outcome::Refused(error) if is_newest => {
                    (self.is_waiting, self.has_failed, self.is_measuring) = (false, true, false);
                    self.times.clear();
                    refused = Err(error);
                }
                Outcome::Measured(samples) if is_newest && !self.is_waiting => {
                    self.is_measuring = false;
                    self.timings.settle(samples);
                }
                Outcome::Refused(_) | Outcome::Measured(_) => {}
            }
        }
        refused
    }

    /// Shows a finished picture.
    fn take(&mut self, inputs: Inputs, drawn: Drawn, latency_ms: f64) {
        let Drawn {
            view,
            size,
            report,
            options,
            plan,
            explanation,
            is_compiled,
            ..
        } = drawn;
        if let Some(view) = view {
            match self.picture.as_mut().filter(|picture| picture.view == view) {
                Some(picture) => picture.size = size,
                None => {
                    let blit = self.blitter.blit(&self.devices.window.device, &view);
                    self.picture = Some(Picture { blit, view, size });
                }
            }
        }
        let sample = report.as_ref().and_then(Sample::of);
        self.timings.drawn(
            Subject {
                size,
                kernel: explanation.key.clone(),
            },
            sample,
            is_compiled,
            latency_ms,
        );
        self.report = report.or(self.report.take());
        (self.drawn, self.options, self.plan, self.explanation) =
            (Some(inputs), options, plan, Some(explanation));
    }
}
