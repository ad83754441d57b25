//! An open preset: its text, its scene, and what the oracle makes of it.

use std::sync::Arc;

use rasterlab_files::preset_file::{self, PresetFile};
use rasterlab_model::{
    accuracy::{AccuracyRequest, DepthFormat, PinnedOptions, VertexTransform, Visibility},
    measure::compare,
    preset::Preset,
    scene::{Scene, builtin},
};
use rasterlab_oracle as oracle;
use wasm_bindgen::prelude::{JsError, wasm_bindgen};

/// A preset and its scene.
#[wasm_bindgen]
pub struct OpenPreset {
    pub(crate) file: PresetFile,
    pub(crate) scene: Arc<Scene>,
}

#[wasm_bindgen]
impl OpenPreset {
    /// Reads a preset: its TOML, or the line that the window copies. `id` is what errors call it.
    ///
    /// # Errors
    /// One sentence on what is wrong with the text or its scene.
    #[wasm_bindgen(constructor)]
    pub fn new(text: &str, id: &str) -> Result<OpenPreset, JsError> {
        let file = if text.trim_start().starts_with("rasterlab1:") {
            preset_file::from_line(text)?
        } else {
            preset_file::parse(text, id)?
        };
        let scene = preset_file::load_scene(&file.preset, None)?;
        Ok(Self { file, scene })
    }

    /// A built-in scene at 320 x 240 with strict accuracy, as `tests/strict_hashes.txt` has it.
    ///
    /// # Errors
    /// No such scene.
    pub fn strict(query: &str) -> Result<OpenPreset, JsError> {
        let mut file = preset_file::parse("schema = 2", query)?;
        let pins = PinnedOptions::of(Visibility::Split32)
            .with(VertexTransform::Strict)
            .with(DepthFormat::Integer);
        let size = [320, 240];
        let scene = Arc::new(builtin::build(query)?);
        file.preset = Preset {
            accuracy: AccuracyRequest {
                pins,
                ..AccuracyRequest::default()
            },
            ..Preset::of_sphere(&scene, size)
        };
        file.preset.output.size = size;
        Ok(Self { file, scene })
    }

    /// The name that is shown.
    pub fn name(&self) -> String {
        self.file.preset.name.clone()
    }

    /// The colors of a golden: the RGBA of a PNG.
    ///
    /// # Errors
    /// The bytes are no PNG.
    pub fn golden(png: &[u8]) -> Result<Vec<u8>, JsError> {
        let (colors, _) = preset_file::pixels_of_png(png, "the golden")?;
        Ok(colors.into_flattened())
    }

    /// The reasons why a picture is not the golden, within the budget of the preset; both RGBA.
    pub fn golden_faults(&self, colors: &[u8], golden: &[u8]) -> Vec<String> {
        let budget = self.file.preset.test.clone().unwrap_or_default();
        let [a, b] = [colors, golden].map(|rgba| rgba.as_chunks().0);
        let delta = compare::pictures(a, b, budget.max_channel);
        let is_over = delta.pixels_over_tolerance > u64::from(budget.max_pixels);
        is_over
            .then(|| {
                format!(
                    "{} pixels differ from the golden, by up to {} of 255",
                    delta.pixels_over_tolerance, delta.max_delta
                )
            })
            .into_iter()
            .collect()
    }

    /// Width and height of its picture, pixels.
    pub fn size(&self) -> Vec<u32> {
        self.file.preset.output.size.to_vec()
    }

    /// Draws it at another size from now on, pixels.
    pub fn resize(&mut self, width: u32, height: u32) {
        self.file.preset.output.size = [width, height];
    }

    /// The line that a link carries after `#`.
    pub fn line(&self) -> String {
        preset_file::to_line(&self.file)
    }
}

/// A picture of the oracle.
#[wasm_bindgen]
pub struct OraclePicture {
    colors: Vec<u8>,
    triangle_ids: Vec<u32>,
}

#[wasm_bindgen]
impl OraclePicture {
    /// RGBA, 8 bits each, row by row from the top.
    pub fn colors(&self) -> Vec<u8> {
        self.colors.clone()
    }

    /// The id of the nearest triangle at every pixel.
    pub fn triangle_ids(&self) -> Vec<u32> {
        self.triangle_ids.clone()
    }
}

/// Draws a preset with the oracle, on this thread: for a worker.
///
/// # Errors
/// One sentence on what it cannot draw.
#[wasm_bindgen]
pub fn oracle_picture(open: &OpenPreset) -> Result<OraclePicture, JsError> {
    let preset = &open.file.preset;
    let moments = preset.moments(&open.scene, preset.output.size);
    let frame = oracle::render_scaled(&open.scene, &moments, preset.accuracy.scale().factor())?;
    Ok(OraclePicture {
        colors: frame.color.into_flattened(),
        triangle_ids: frame.triangle_id,
    })
}
