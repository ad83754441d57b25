//! Screen: a picture in the window and the renderer that draws it. It draws only when an input has changed; after a failure
//! the last good picture stays.

use std::sync::Arc;

use eframe::{egui_wgpu, wgpu};

use super::blit::{Blit, Blitter};
use crate::{
    accuracy::AccuracyOptions,
    effects::Stack,
    gpu::{Explanation, Gpu, RenderError, Renderer, Report},
    plan::Plan,
    preset::AccuracyRequest,
    scene::{Scene, view::View},
};

/// Everything a picture depends on.
#[derive(Clone, Debug)]
pub struct Inputs {
    pub scene: Arc<Scene>,
    pub view: View,
    pub stack: Stack,
    pub accuracy: AccuracyRequest,
}

impl PartialEq for Inputs {
    fn eq(&self, other: &Self) -> bool {
        let Self { scene, view, stack, accuracy } = self;
        Arc::ptr_eq(scene, &other.scene) && *view == other.view && *stack == other.stack && *accuracy == other.accuracy
    }
}

/// Most redraws of the same inputs. A queue that overflowed has the right size after one or two.
const MAX_REDRAWS: u32 = 6;

/// Seconds after which a report that has not arrived is given up.
const REPORT_TIMEOUT_S: f64 = 10.0;

/// A picture in the window and the renderer that draws it.
pub struct Screen {
    pub gpu: Arc<Gpu>,
    renderer: Renderer,
    blitter: Blitter,
    picture: Option<Picture>,
    /// The inputs that were requested last, at full size.
    requested: Option<Inputs>,
    divisor: u32,
    /// What the newest picture was made from; smaller than requested while it moves on a slow adapter.
    drawn: Option<Inputs>,
    /// Inputs that could not be drawn; not tried again until they change.
    refused: Option<Inputs>,
    report: Option<Report>,
    explanation: Option<Explanation>,
    waiting_since_s: Option<f64>,
    redraws: u32,
    /// The newest frame compiled pipelines, so its time does not count and one more frame is drawn.
    cold: bool,
    draws: u64,
}

/// What the window shows.
struct Picture {
    blit: Blit,
    view: wgpu::TextureView,
    size: [u32; 2],
}

impl Screen {
    pub fn new(window: &egui_wgpu::RenderState, gpu: Arc<Gpu>) -> Self {
        Self::with(gpu, Blitter::new(window))
    }

    fn with(gpu: Arc<Gpu>, blitter: Blitter) -> Self {
        Self {
            renderer: Renderer::new(gpu.clone()),
            gpu,
            blitter,
            picture: None,
            requested: None,
            divisor: 1,
            drawn: None,
            refused: None,
            report: None,
            explanation: None,
            waiting_since_s: None,
            redraws: 0,
            cold: false,
            draws: 0,
        }
    }

    /// A second screen on the same device, for another picture in the same window.
    pub fn sibling(&self) -> Self {
        let Self { gpu, blitter, .. } = self;
        Self::with(gpu.clone(), blitter.clone())
    }

    /// Draws the next picture with the shaders as they are now, and again if the last one could not be drawn.
    pub fn reload_shaders(&mut self) {
        self.renderer = Renderer::new(self.gpu.clone());
        (self.drawn, self.refused, self.waiting_since_s) = (None, None, None);
    }

    /// True if the device was lost. Polls it, since nothing else does while nothing is drawn.
    pub fn is_lost(&self) -> bool {
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        self.gpu.is_lost()
    }

    /// Number of frames dispatched so far.
    pub fn draws(&self) -> u64 {
        self.draws
    }

    /// The newest picture and its size in pixels.
    pub fn picture(&self) -> Option<(&Blit, [u32; 2])> {
        self.picture.as_ref().map(|picture| (&picture.blit, picture.size))
    }

    /// How the newest picture differs from another screen's, times `gain`.
    pub fn difference(&self, other: &Self, gain: u8) -> Option<Blit> {
        let views = [&self.picture.as_ref()?.view, &other.picture.as_ref()?.view];
        Some(self.blitter.difference(&self.gpu.device, views, gain))
    }

    /// The inputs that were requested last, at full size; none before the first.
    pub fn requested(&self) -> Option<&Inputs> {
        self.requested.as_ref()
    }

    /// What the newest picture was made from.
    pub fn drawn(&self) -> Option<&Inputs> {
        self.drawn.as_ref()
    }

    /// Times and counters of the newest finished frame.
    pub fn report(&self) -> Option<&Report> {
        self.report.as_ref()
    }

    /// The accuracy options of the newest picture's kernel.
    pub fn options(&self) -> Option<AccuracyOptions> {
        self.renderer.key().map(|key| key.options)
    }

    /// The plan of the newest picture.
    pub fn plan(&self) -> Option<&Plan> {
        self.renderer.plan()
    }

    /// What the newest picture ran, and why.
    pub fn explanation(&self) -> Option<&Explanation> {
        self.explanation.as_ref()
    }

    /// True if the requested picture was tried and could not be drawn.
    pub fn is_refused(&self) -> bool {
        self.refused.is_some() && self.refused == self.requested
    }

    /// True while a report is still to come; the window must be shown again soon.
    pub fn is_waiting(&self) -> bool {
        self.waiting_since_s.is_some()
    }

    /// Full pixels per drawn pixel along a side; above 1 while the picture moves on a slow adapter.
    pub fn divisor(&self) -> u32 {
        self.divisor
    }

    /// Draws `requested` at its size over `divisor`, unless that is what the picture shows or what could not be drawn.
    ///
    /// # Errors
    /// If the scene or the effects cannot be drawn on this device.
    pub fn show(&mut self, requested: Inputs, divisor: u32, now_s: f64) -> Result<(), RenderError> {
        let mut inputs = requested.clone();
        // The same frustum on fewer pixels, so that nothing jumps when the motion ends.
        inputs.view.width = inputs.view.width.div_ceil(divisor);
        inputs.view.height = inputs.view.height.div_ceil(divisor);
        (self.requested, self.divisor) = (Some(requested), divisor);
        if self.drawn.as_ref() == Some(&inputs) || self.refused.as_ref() == Some(&inputs) {
            return Ok(());
        }
        self.redraws = 0;
        self.draw(&inputs, now_s)
    }

    fn draw(&mut self, inputs: &Inputs, now_s: f64) -> Result<(), RenderError> {
        let compiled = self.renderer.compiled();
        let drawn = self.dispatch(inputs);
        self.cold = self.renderer.compiled() > compiled;
        if drawn.is_err() {
            self.refused = Some(inputs.clone());
            return drawn;
        }
        self.refused = None;
        self.drawn = Some(inputs.clone());
        self.draws += 1;
        self.waiting_since_s = self.renderer.is_pending().then_some(now_s);
        self.explanation = Some(self.renderer.explain());
        self.register([inputs.view.width, inputs.view.height]);
        Ok(())
    }

    fn dispatch(&mut self, Inputs { scene, view, stack, accuracy }: &Inputs) -> Result<(), RenderError> {
        self.renderer.set_scene(scene)?;
        self.renderer.draw(view, stack, accuracy)
    }

    /// Gives the renderer's texture to the window, unless the window has it already.
    fn register(&mut self, size: [u32; 2]) {
        let Some(view) = self.renderer.texture_view() else { return };
        if let Some(picture) = self.picture.as_mut().filter(|picture| picture.view == *view) {
            picture.size = size;
            return;
        }
        let blit = self.blitter.blit(&self.gpu.device, view);
        self.picture = Some(Picture { blit, view: view.clone(), size });
    }

    /// Takes a report that has arrived, without waiting; draws again if a queue had overflowed and has grown.
    ///
    /// # Errors
    /// If that draw fails.
    pub fn poll(&mut self, now_s: f64) -> Result<(), RenderError> {
        let Some(since_s) = self.waiting_since_s else { return Ok(()) };
        let Some(report) = self.renderer.report() else {
            if now_s - since_s > REPORT_TIMEOUT_S {
                self.waiting_since_s = None;
            }
            return Ok(());
        };
        let again = report.simulation_pending || (report.redraw || self.cold) && self.redraws < MAX_REDRAWS;
        self.report = Some(report);
        if self.renderer.is_pending() {
            return Ok(());
        }
        self.waiting_since_s = None;
        match self.drawn.clone() {
            Some(inputs) if again => {
                self.redraws += 1;
                self.draw(&inputs, now_s)
            }
            _ => Ok(()),
        }
    }
}
