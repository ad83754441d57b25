//! Pictures that move: drawn on the device, and shown on a canvas without being read back or counted.

use std::sync::Arc;

use rasterlab_gpu::{
    Gpu, RenderError, Renderer, canvas::Canvas, hardware::Hardware, idle, particles::Wait,
    timer::Detail,
};
use wasm_bindgen::prelude::{JsError, wasm_bindgen};
use web_sys::HtmlCanvasElement;
use web_time::Instant;

use crate::{open_preset::OpenPreset, page::Page};

/// How often a frame is drawn again because a queue overflowed.
const MOST_REDRAWS: usize = 11;

/// Frames are repeated until they take so long together, since a browser rounds its clock.
const MEASURED_MS: f64 = 20.0;
/// Most frames of one measurement.
const MOST_FRAMES: u32 = 64;

/// What draws the frames.
enum Painter {
    /// Our kernels.
    Kernels(Box<Renderer>),
    /// The adapter's own rasterizer.
    Hardware(Option<Box<Hardware>>),
}

/// What draws frames, and the canvas that shows them if there is one.
#[wasm_bindgen]
pub struct Live {
    gpu: Arc<Gpu>,
    canvas: Option<Canvas>,
    painter: Painter,
}

#[wasm_bindgen]
impl Live {
    /// Our kernels, on a canvas if there is one.
    ///
    /// # Errors
    /// When the canvas gives no WebGPU surface.
    #[wasm_bindgen(constructor)]
    pub fn new(page: &Page, canvas: Option<HtmlCanvasElement>) -> Result<Live, JsError> {
        let renderer = Box::new(Renderer::new(page.gpu.clone()));
        Ok(Self {
            gpu: page.gpu.clone(),
            canvas: canvas.map(Canvas::new).transpose()?,
            painter: Painter::Kernels(renderer),
        })
    }

    /// The adapter's own rasterizer.
    pub fn hardware(page: &Page) -> Live {
        Self {
            gpu: page.gpu.clone(),
            canvas: None,
            painter: Painter::Hardware(None),
        }
    }

    /// Draws a frame, and shows it when it is finished.
    ///
    /// # Errors
    /// One sentence on what cannot be drawn here.
    pub async fn show(&mut self, open: &OpenPreset) -> Result<(), JsError> {
        self.draw(open, 1).await?;
        if let (Painter::Kernels(renderer), Some(canvas)) = (&self.painter, &mut self.canvas)
            && let Some(picture) = renderer.texture()
        {
            canvas.show(&self.gpu, picture);
        }
        self.faultless()
    }

    /// Milliseconds of a frame, measured over many: with what the page needs to ask for them.
    ///
    /// # Errors
    /// One sentence on what cannot be drawn here.
    pub async fn milliseconds(&mut self, open: &OpenPreset) -> Result<f64, JsError> {
        self.draw(open, 1).await?;
        let mut frames = 1;
        loop {
            let begin = Instant::now();
            self.draw(open, frames).await?;
            let passed_ms = begin.elapsed().as_secs_f64() * 1e3;
            if passed_ms >= MEASURED_MS || frames >= MOST_FRAMES {
                self.faultless()?;
                return Ok(passed_ms / f64::from(frames));
            }
            frames *= 2;
        }
    }

    /// Draws a frame and reads it back: RGBA, 8 bits each; alpha is 0 where the adapter's own
    /// rasterizer drew nothing.
    ///
    /// # Errors
    /// One sentence on what cannot be drawn here.
    pub async fn colors(&mut self, open: &OpenPreset) -> Result<Vec<u8>, JsError> {
        self.draw(open, 1).await?;
        let colors = match &mut self.painter {
            Painter::Kernels(renderer) => renderer.read_shown().await?.unwrap_or_default(),
            Painter::Hardware(Some(hardware)) => hardware.picture(&self.gpu).await?,
            Painter::Hardware(None) => Vec::new(),
        };
        self.faultless()?;
        Ok(colors.into_flattened())
    }
}

impl Live {
    fn faultless(&self) -> Result<(), JsError> {
        match self.gpu.take_error() {
            Some(error) => Err(JsError::new(&format!("the device reports {error}"))),
            None => Ok(()),
        }
    }

    /// Draws so many frames and returns when they are finished.
    async fn draw(&mut self, open: &OpenPreset, frames: u32) -> Result<(), JsError> {
        match &mut self.painter {
            Painter::Kernels(renderer) => draw_kernels(renderer, open, frames).await,
            Painter::Hardware(hardware) => draw_hardware(&self.gpu, hardware, open, frames).await,
        }
    }
}

async fn draw_kernels(
    renderer: &mut Renderer,
    open: &OpenPreset,
    frames: u32,
) -> Result<(), JsError> {
    renderer.set_scene(&open.scene).await?;
    let ((view, stack), accuracy) = (open.moment(), &open.file.preset.accuracy);
    for _ in 0..MOST_REDRAWS {
        for _ in 0..frames {
            renderer
                .draw_timed(&view, &stack, accuracy, Detail::Whole, Wait::Simulation)
                .await?;
        }
        if view.pixels() == 0 || !renderer.finish().await?.redraw {
            return Ok(());
        }
    }
    Err(RenderError::Overflow(0).into())
}

async fn draw_hardware(
    gpu: &Arc<Gpu>,
    hardware: &mut Option<Box<Hardware>>,
    open: &OpenPreset,
    frames: u32,
) -> Result<(), JsError> {
    let (view, stack) = open.moment();
    let hardware = match hardware {
        Some(made) => made,
        None => {
            // The key of our own kernels for the same picture says what its shaders are linked from.
            let mut renderer = Renderer::new(gpu.clone());
            draw_kernels(&mut renderer, open, 1).await?;
            let key = renderer.key().ok_or(RenderError::NoScene)?;
            let made = Hardware::new(gpu, &open.scene, &view, &stack, key).await?;
            hardware.insert(Box::new(made.map_err(|why| JsError::new(&why))?))
        }
    };
    hardware.look(gpu, &open.scene, &view, &stack).await?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    for _ in 0..frames {
        hardware.record(&mut encoder, None)?;
    }
    gpu.queue.submit([encoder.finish()]);
    Ok(idle(gpu).await?)
}
