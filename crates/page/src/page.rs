//! The page's device: presets drawn on it, read back and judged.

use std::sync::Arc;

use rasterlab_gpu::{Capture, Gpu, Renderer, device::AdapterChoice};
use rasterlab_model::{frame::Frame, math::fnv1a};
use rasterlab_oracle as oracle;
use wasm_bindgen::prelude::{JsError, wasm_bindgen};

use crate::open_preset::OpenPreset;

/// Draws on the page's device.
#[wasm_bindgen]
pub struct Page {
    pub(crate) gpu: Arc<Gpu>,
    renderer: Renderer,
}

#[wasm_bindgen]
impl Page {
    /// Opens the browser's device.
    ///
    /// # Errors
    /// When the browser offers no WebGPU adapter or gives no device.
    pub async fn open() -> Result<Page, JsError> {
        let gpu = Gpu::open(&AdapterChoice::Any).await?;
        let renderer = Renderer::new(gpu.clone());
        Ok(Self { gpu, renderer })
    }

    /// The adapter's name, as far as the browser tells it.
    pub fn adapter(&self) -> String {
        let summary = &self.gpu.summary;
        let known = [&summary.name, &summary.driver];
        let known: Vec<&str> = known
            .iter()
            .map(|word| word.trim())
            .filter(|word| !word.is_empty())
            .collect();
        known.join(", ")
    }

    /// Has the device been lost? Then the page opens another one, if it can.
    pub fn is_lost(&self) -> bool {
        self.gpu.is_lost()
    }

    /// Draws a preset and reads the picture back.
    ///
    /// # Errors
    /// One sentence on what cannot be drawn here.
    pub async fn draw(&mut self, open: &OpenPreset) -> Result<Picture, JsError> {
        let preset = &open.file.preset;
        self.renderer.set_scene(&open.scene).await?;
        let moments = preset.moments(&open.scene, preset.output.size);
        let capture = self
            .renderer
            .capture_last(&moments, &preset.accuracy)
            .await?;
        match self.gpu.take_error() {
            Some(error) => Err(JsError::new(&format!("the device reports {error}"))),
            None => Ok(Picture { capture }),
        }
    }
}

/// A picture that the device drew.
#[wasm_bindgen]
pub struct Picture {
    capture: Capture,
}

#[wasm_bindgen]
impl Picture {
    /// RGBA, 8 bits each, row by row from the top, at the size that is shown.
    pub fn colors(&self) -> Vec<u8> {
        self.shown().color.as_flattened().to_vec()
    }

    /// Width and height of what [`Picture::colors`] returns, pixels.
    pub fn size(&self) -> Vec<u32> {
        let shown = self.shown();
        vec![shown.width, shown.height]
    }

    /// FNV-1a of all triangle ids and of all depth keys, 16 hexadecimal digits each: the columns of
    /// `tests/strict_hashes.txt`.
    pub fn hashes(&self) -> Vec<String> {
        let frame = &self.capture.frame;
        [&frame.triangle_id, &frame.depth_key]
            .map(|words| format!("{:016x}", fnv1a(words)))
            .to_vec()
    }

    /// Judges the picture with the oracle, on this thread.
    ///
    /// # Errors
    /// One sentence on what the oracle cannot judge.
    pub fn judge(&self, open: &OpenPreset) -> Result<Judged, JsError> {
        let preset = &open.file.preset;
        let (view, stack) = (
            preset.view(&open.scene, preset.output.size),
            preset.stack_on(&open.scene, preset.output.size),
        );
        let verdict = oracle::judge(&open.scene, &view, &stack, &self.capture.picture())?;
        let budget = preset.test.clone().unwrap_or_default();
        let over = budget.pixels_over_tolerance(&verdict, &self.capture.frame);
        Ok(Judged {
            faults: budget.faults(&verdict.report, over, false),
            allowed: over as f64,
        })
    }
}

/// What the oracle found.
#[wasm_bindgen(getter_with_clone)]
pub struct Judged {
    /// The reasons why the picture is wrong, none if it is right.
    pub faults: Vec<String>,
    /// Pixels whose color is farther from the oracle's than rounding explains, which the preset allows
    /// if there are no faults.
    pub allowed: f64,
}

impl Picture {
    fn shown(&self) -> &Frame {
        self.capture.shown.as_ref().unwrap_or(&self.capture.frame)
    }
}
