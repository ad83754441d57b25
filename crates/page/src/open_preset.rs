//! An open preset: its text, its scene, and the camera and time that a visitor gives it.

use std::{path::Path, sync::Arc};

use rasterlab_files::{
    host::disk,
    preset_file::{self, ModelFormat, PresetFile},
};
use rasterlab_model::{
    accuracy::AccuracyRequest,
    effects::Stack,
    frame::Frame,
    math::fnv1a,
    measure::compare,
    preset::{Preset, SceneSource},
    scene::{
        Scene, builtin,
        camera_moves::{orbit, zoom},
        view::View,
    },
};
use rasterlab_oracle as oracle;
use wasm_bindgen::prelude::{JsError, wasm_bindgen};

/// A preset and its scene.
#[derive(Clone)]
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

    /// A model that [`give_file`] has put at `path`, as the window shows it first.
    ///
    /// # Errors
    /// One sentence on what is wrong with the model.
    pub fn of_model(path: &str) -> Result<OpenPreset, JsError> {
        let mut file = model_file(path)?;
        let scene = preset_file::load_scene(&file.preset, None)?;
        file.settle(&scene, true);
        Ok(Self { file, scene })
    }

    /// This look on a model that [`give_file`] has put at `path`, its lengths fitted to the model.
    ///
    /// # Errors
    /// One sentence on what is wrong with the model.
    pub fn on_model(&self, path: &str) -> Result<OpenPreset, JsError> {
        let (look, own) = (&self.file, model_file(path)?);
        let scene = preset_file::load_scene(&own.preset, None)?;
        let boxes = [
            &preset_file::scene_bounds(&look.preset.scene, look.preset.parts.up, None)?,
            &scene.content_bounds(),
        ];
        let fit = look.fit_to(&own, boxes, Some(&scene));
        let mut file = look.landed_on(&own, fit.as_ref());
        file.map_missing_parts(&scene);
        let scene = preset_file::load_scene(&file.preset, None)?;
        Ok(Self { file, scene })
    }

    /// A built-in scene at 320 x 240 with strict accuracy, as `tests/strict_hashes.txt` has it.
    ///
    /// # Errors
    /// No such scene.
    pub fn strict(query: &str) -> Result<OpenPreset, JsError> {
        let mut file = preset_file::parse("schema = 2", query)?;
        let size = [320, 240];
        let scene = Arc::new(builtin::build(query)?);
        file.preset = Preset {
            accuracy: AccuracyRequest::portable_bits(),
            ..Preset::of_sphere(&scene, size)
        };
        file.preset.output.size = size;
        Ok(Self { file, scene })
    }

    /// The same preset, drawn so that its triangle ids and depth keys are the same bits everywhere.
    pub fn in_portable_bits(&self) -> OpenPreset {
        let mut same = self.clone();
        same.file.preset.accuracy = AccuracyRequest::portable_bits();
        same
    }

    /// The same preset, which another camera, size or time leaves as it is.
    pub fn copy(&self) -> OpenPreset {
        self.clone()
    }

    /// The name that is shown.
    pub fn name(&self) -> String {
        self.file.preset.name.clone()
    }

    /// What it shows, in one sentence; empty if its file does not say.
    pub fn about(&self) -> String {
        self.file.preset.about.clone()
    }

    /// The WGSL of the effects that the preset's own text contains, for the visitor to read before it
    /// runs; empty if it contains none.
    pub fn brought_code(&self) -> String {
        let is_brought = |stem: &String| self.file.brought_effects.contains(stem);
        let effects = self.file.preset.stack.0.iter();
        effects
            .filter_map(|enabled| enabled.effect.source.as_ref())
            .filter(|source| is_brought(&source.stem))
            .map(|source| format!("// {}.wgsl\n{}", source.stem, source.written))
            .collect::<Vec<_>>()
            .join("\n")
    }

    /// What the picture does not show as its files ask, a sentence each: parts of a model that are
    /// lost or ignored, and what a look cannot take along to it.
    pub fn notes(&self) -> Vec<String> {
        let notes = self.scene.notes.iter().chain(&self.file.warnings);
        notes.cloned().collect()
    }

    /// The text of a file that holds it.
    pub fn text(&self) -> String {
        preset_file::to_shared_toml(&self.file)
    }

    /// Changes one value, for instance `accuracy.depth`.
    ///
    /// # Errors
    /// One sentence on what is wrong with the path or the value.
    pub fn set(&mut self, path: &str, value: &str) -> Result<(), JsError> {
        Ok(preset_file::set(&mut self.file, path, value)?)
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

    /// Draws it at another size from now on, pixels; lengths in pixels grow and shrink with it.
    pub fn resize(&mut self, width: u32, height: u32) {
        self.file.preset.output.resize([width, height]);
    }

    /// Does its picture depend on the time?
    pub fn is_moving(&self) -> bool {
        self.file.preset.is_moving()
    }

    /// Lets so many seconds of playback pass. Returns false at the end of a range that does not
    /// start again.
    pub fn play(&mut self, passed_s: f64) -> bool {
        let clock = &mut self.file.preset.clock;
        let (time_s, goes_on) = clock.after(clock.time_s, passed_s);
        clock.time_s = time_s;
        goes_on
    }

    /// Moves the eye around what the camera looks at, by angles in degrees, and to `closer` times
    /// its distance.
    pub fn orbit(&mut self, aside_deg: f64, up_deg: f64, closer: f64) {
        let [width, height] = self.file.preset.output.size;
        let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
        let mut preset = self.file.preset.metric(&self.scene).into_owned();
        let mut camera = preset.camera_for(&self.scene, aspect);
        orbit(&mut camera, -aside_deg.to_radians(), up_deg.to_radians());
        zoom(&mut camera, closer);
        preset.camera = Some(camera);
        self.file.preset = preset;
    }

    /// The line that a link carries after `#`.
    pub fn line(&self) -> String {
        preset_file::to_line(&self.file)
    }
}

impl OpenPreset {
    /// View and stack of its picture.
    pub(crate) fn moment(&self) -> (View, Stack) {
        let (preset, size) = (&self.file.preset, self.file.preset.output.size);
        (
            preset.view(&self.scene, size),
            preset.stack_on(&self.scene, size),
        )
    }
}

/// Puts a file where models are looked for.
#[wasm_bindgen]
pub fn give_file(path: &str, bytes: &[u8]) {
    disk::put(Path::new(path), bytes);
}

/// A preset of the model at `path`.
fn model_file(path: &str) -> Result<PresetFile, JsError> {
    let path = Path::new(path);
    if ModelFormat::of(path).is_none() {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let formats = ModelFormat::names(" and ");
        let refused = format!("{name:?} is no model by its name: models are {formats} files");
        return Err(JsError::new(&refused));
    }
    let id = path.file_stem().unwrap_or_default().to_string_lossy();
    let source = SceneSource::File(path.to_owned());
    Ok(PresetFile::of_scene(&id, source))
}

/// How many workers can share the oracle's picture: any number, or 1.
#[wasm_bindgen]
pub fn can_share_rows(open: &OpenPreset) -> bool {
    let (_, stack) = open.moment();
    let has_layers = stack.layers(open.scene.triangle_count()).is_some();
    open.file.preset.accuracy.scale().factor() == 1.0 && !has_layers
}

/// Draws rows of a preset with the oracle, on this thread: for a worker. RGBA, 8 bits each, row by
/// row from the top; `rows_end` is the first row that is not drawn. A preset whose rows cannot be
/// shared is drawn whole.
///
/// # Errors
/// One sentence on what it cannot draw.
#[wasm_bindgen]
pub fn oracle_rows(open: &OpenPreset, rows_begin: u32, rows_end: u32) -> Result<Vec<u8>, JsError> {
    let preset = &open.file.preset;
    let moments = preset.moments(&open.scene, preset.output.size);
    let Some((last, before)) = moments.split_last().filter(|_| can_share_rows(open)) else {
        let frame = oracle::render_scaled(&open.scene, &moments, preset.accuracy.scale().factor())?;
        return Ok(frame.color.into_flattened());
    };
    let before = match before {
        [] => None,
        before => Some(oracle::render_sequence(&open.scene, before)?),
    };
    let earlier = before.as_ref().map(Frame::earlier);
    let (view, stack) = last;
    let rows = rows_begin..rows_end;
    let frame = oracle::render_rows(&open.scene, view, stack, earlier, rows)?;
    Ok(frame.color.into_flattened())
}

/// FNV-1a of the triangle ids and of the depth keys that the oracle finds in portable bits, 16
/// hexadecimal digits each: what `rasterlab link` writes behind a line.
///
/// # Errors
/// One sentence on what it cannot draw.
#[wasm_bindgen]
pub fn oracle_bits(open: &OpenPreset) -> Result<Vec<String>, JsError> {
    let (view, stack) = open.moment();
    let (triangle_ids, depth_keys) = oracle::strict_frame(&open.scene, &view, &stack)?;
    Ok([triangle_ids, depth_keys]
        .map(|words| format!("{:016x}", fnv1a(&words)))
        .to_vec())
}
