//! Screen: the picture in the window. Draws when an input changed and never otherwise; a failure leaves the last good
//! picture where it is.

use std::sync::Arc;

use eframe::{egui_wgpu, wgpu};

use super::blit::{Blit, Blitter};
use crate::{
    accuracy::AccuracyOptions,
    effects::Stack,
    gpu::{Explanation, Gpu, RenderError, Renderer, Report},
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

/// Draws of the same inputs, at most: a queue grows to what a picture needs in one or two.
const MAX_REDRAWS: u32 = 6;

/// How long figures may take to arrive before nobody waits for them any more, seconds.
const PATIENCE_S: f64 = 10.0;

/// The renderer of the window, and its newest picture.
pub struct Screen {
    pub gpu: Arc<Gpu>,
    renderer: Renderer,
    blitter: Blitter,
    picture: Option<Picture>,
    drawn: Option<Inputs>,
    /// Inputs that could not be drawn; not tried again until they change.
    refused: Option<Inputs>,
    report: Option<Report>,
    explanation: Option<Explanation>,
    waiting_since_s: Option<f64>,
    redraws: u32,
    /// The newest frame compiled pipelines: its time says nothing, so one more is drawn for the figures.
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

    /// Another screen on the same device, for another picture in the same window.
    pub fn sibling(&self) -> Self {
        let Self { gpu, blitter, .. } = self;
        Self::with(gpu.clone(), blitter.clone())
    }

    /// Has the device been lost? Asks it, since nothing else would while nothing is drawn.
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

    /// What the newest picture was made from.
    pub fn drawn(&self) -> Option<&Inputs> {
        self.drawn.as_ref()
    }

    /// Figures of the newest finished frame.
    pub fn report(&self) -> Option<&Report> {
        self.report.as_ref()
    }

    /// The options of the newest picture's kernel.
    pub fn options(&self) -> Option<AccuracyOptions> {
        self.renderer.key().map(|key| key.options)
    }

    /// What the newest picture ran, and why.
    pub fn explanation(&self) -> Option<&Explanation> {
        self.explanation.as_ref()
    }

    /// Were these inputs tried and refused?
    pub fn is_refused(&self, inputs: &Inputs) -> bool {
        self.refused.as_ref() == Some(inputs)
    }

    /// Are figures still to come? Then show this window again soon.
    pub fn is_waiting(&self) -> bool {
        self.waiting_since_s.is_some()
    }

    /// Draws `inputs`, unless they are what the picture shows already or what was refused.
    pub fn show(&mut self, inputs: &Inputs, now_s: f64) -> Result<(), RenderError> {
        if self.drawn.as_ref() == Some(inputs) || self.is_refused(inputs) {
            return Ok(());
        }
        self.redraws = 0;
        self.draw(inputs, now_s)
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

    /// Gives the renderer's texture to the window; cheap when it is the one the window has.
    fn register(&mut self, size: [u32; 2]) {
        let Some(view) = self.renderer.texture_view() else { return };
        if let Some(picture) = self.picture.as_mut().filter(|picture| picture.view == *view) {
            picture.size = size;
            return;
        }
        let blit = self.blitter.blit(&self.gpu.device, view);
        self.picture = Some(Picture { blit, view: view.clone(), size });
    }

    /// Collects figures without waiting; draws again when a queue had overflowed and has grown.
    pub fn poll(&mut self, now_s: f64) -> Result<(), RenderError> {
        let Some(since_s) = self.waiting_since_s else { return Ok(()) };
        let Some(report) = self.renderer.report() else {
            if now_s - since_s > PATIENCE_S {
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
