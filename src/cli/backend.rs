//! The backend that draws presets: an adapter or the oracle.

use std::sync::Arc;

use pollster::FutureExt as _;
use serde_json::{Value, json};

use super::{args::Common, error::CliError, loading, streams::Streams};
use crate::{
    effects::Stack,
    frame::{Frame, MeanPicture},
    gpu::{
        Capture, Gpu, Renderer,
        device::{AdapterChoice, AdapterSummary, Caps},
    },
    measure::{ErrorReport, Verdict},
    oracle,
    params::legible_line,
    preset::{NO_CAMERA, Preset, Visibility},
    preset_file::{self, PresetError, PresetFile, Provenance},
    scene::{Scene, draw::DrawError, view::View},
};

/// The backend that `--adapter` or the environment names.
pub enum BackendChoice {
    Oracle,
    Gpu(AdapterChoice),
}

/// Reads `--adapter` or the environment; `cpu` names the oracle.
pub fn backend_choice(common: &Common) -> BackendChoice {
    match common.adapter_name() {
        Some(name) if name.eq_ignore_ascii_case("cpu") => BackendChoice::Oracle,
        Some(name) => BackendChoice::Gpu(AdapterChoice::Named(name)),
        None => BackendChoice::Gpu(AdapterChoice::Any),
    }
}

/// Draws presets.
pub enum Backend {
    /// The built-in oracle; needs no driver.
    Oracle,
    Gpu(Box<Renderer>, Arc<Gpu>),
}

impl Backend {
    /// Opens the chosen backend and names it on stderr. There is no fallback.
    pub fn open(common: &Common, streams: &Streams) -> Result<Self, CliError> {
        let backend = match backend_choice(common) {
            BackendChoice::Oracle => Self::Oracle,
            BackendChoice::Gpu(choice) => {
                let gpu = Gpu::open(&choice).block_on()?;
                Self::Gpu(Box::new(Renderer::new(gpu.clone())), gpu)
            }
        };
        streams.note(&format!("adapter: {}", backend.describe()));
        Ok(backend)
    }

    fn describe(&self) -> String {
        match self {
            Self::Oracle => "cpu (the built-in oracle)".into(),
            Self::Gpu(_, gpu) => describe(&gpu.summary, &gpu.caps),
        }
    }

    /// Name of the adapter, or `cpu`.
    pub fn name(&self) -> &str {
        match self {
            Self::Oracle => "cpu",
            Self::Gpu(_, gpu) => &gpu.summary.name,
        }
    }

    /// What a saved picture says about the backend that drew it.
    pub fn provenance(&self) -> Provenance {
        let driver = match self {
            Self::Oracle => format!("oracle {}", env!("CARGO_PKG_VERSION")),
            Self::Gpu(_, gpu) => format!("{} ({})", gpu.summary.driver, gpu.summary.backend),
        };
        Provenance {
            adapter: self.name().into(),
            driver,
        }
    }

    /// The `adapter` of a JSON object.
    pub fn json(&self) -> Value {
        match self {
            Self::Oracle => {
                json!({ "name": "cpu", "backend": "cpu", "driver": self.provenance().driver, "software": true, "class": "oracle" })
            }
            Self::Gpu(_, gpu) => adapter_json(&gpu.summary, &gpu.caps),
        }
    }

    /// `native-int64`, `portable` or `oracle`.
    pub fn class(&self) -> &'static str {
        match self {
            Self::Oracle => "oracle",
            Self::Gpu(_, gpu) => gpu.caps.class(),
        }
    }

    /// Visibility options this backend can draw `session` with: the pinned one, or all that the
    /// adapter has.
    pub fn options(&self, preset: &Preset) -> Vec<Option<Visibility>> {
        match (self, preset.accuracy.pins.option::<Visibility>()) {
            (Self::Oracle, _) => vec![None],
            (_, Some(pinned)) => vec![Some(pinned)],
            (Self::Gpu(_, gpu), None) => usable_options(&gpu.caps).into_iter().map(Some).collect(),
        }
    }

    /// The picture of `session`.
    pub fn frame(&mut self, preset: &Preset, scene: &Arc<Scene>) -> Result<Frame, CliError> {
        // A picture whose samples do not fit at once is drawn as several.
        let scale = preset.accuracy.scale().factor();
        let moments = self.moments(preset, scene, scale.min(1.0))?;
        match self {
            Self::Oracle => {
                if scale <= 1.0 || oracle::can_draw_sequence(scene, &moments, scale).is_ok() {
                    return Ok(oracle::render_scaled(scene, &moments, scale)?);
                }
                // One picture after another for the samples of a pixel.
                let mut mean = MeanPicture::default();
                for shift in MeanPicture::shifts(scale as u32) {
                    let moved: Vec<_> = moments
                        .iter()
                        .map(|(view, stack)| (view.shifted(shift), stack.clone()))
                        .collect();
                    mean.add(oracle::render_scaled(scene, &moved, 1.0)?);
                }
                Ok(mean.frame().expect("a pixel has samples"))
            }
            Self::Gpu(renderer, _) => {
                renderer.set_scene(scene).block_on()?;
                Ok(renderer.still(&moments, &preset.accuracy).block_on()?)
            }
        }
    }

    /// The color of a pixel (column, row) inside the picture of `preset`. The oracle shades its row
    /// alone where it can.
    pub fn pixel(
        &mut self,
        preset: &Preset,
        scene: &Arc<Scene>,
        [x, y]: [u32; 2],
    ) -> Result<[u8; 4], CliError> {
        let scale = preset.accuracy.scale().factor();
        let moments = self.moments(preset, scene, scale.min(1.0))?;
        if matches!(self, Self::Oracle)
            && (scale <= 1.0 || oracle::can_draw_sequence(scene, &moments, scale).is_ok())
        {
            return Ok(oracle::render_scaled_row(scene, &moments, scale, y)?[x as usize]);
        }
        let frame = self.frame(preset, scene)?;
        Ok(frame.color[(y * frame.width + x) as usize])
    }

    /// What is drawn for a picture, in order, with `factor` times as many pixels to a side.
    ///
    /// # Errors
    /// It would take a CPU minutes.
    fn moments(
        &self,
        preset: &Preset,
        scene: &Scene,
        factor: f64,
    ) -> Result<Vec<(View, Stack)>, DrawError> {
        let moments = preset.moments(scene, preset.output.size);
        let is_cpu = match self {
            Self::Oracle => true,
            Self::Gpu(_, gpu) => gpu.summary.software,
        };
        if is_cpu {
            oracle::can_draw_sequence(scene, &moments, factor)?;
        }
        Ok(moments)
    }

    /// The verdict on a capture of this backend. The oracle's own picture is the reference.
    pub fn judged(
        &self,
        scene: &Scene,
        view: &View,
        stack: &Stack,
        capture: &Capture,
    ) -> Result<Verdict, DrawError> {
        match self {
            Self::Gpu(..) => oracle::judge(scene, view, stack, &capture.picture()),
            Self::Oracle => {
                let report = ErrorReport {
                    pixels: view.pixels() as u64,
                    ..ErrorReport::default()
                };
                Ok(Verdict {
                    report,
                    expected: capture.frame.clone(),
                    ..Verdict::default()
                })
            }
        }
    }

    /// The picture with all that a judge needs; `again`: after itself, if no effect remembers any.
    pub fn capture(
        &mut self,
        preset: &Preset,
        scene: &Arc<Scene>,
        again: bool,
    ) -> Result<Capture, CliError> {
        let factor = preset.accuracy.scale().factor();
        let mut moments = self.moments(preset, scene, factor)?;
        if again && preset.stack.earlier_frames().is_none() {
            moments.extend_from_within(..);
        }
        match self {
            Self::Oracle => {
                let ((view, stack), before) = moments
                    .split_last()
                    .expect("a preset has at least one frame");
                let drawn = || oracle::render_sequence(scene, before);
                let before = (!before.is_empty()).then(drawn).transpose()?;
                let earlier = before.as_ref().map(Frame::earlier);
                let (frame, geometry) = oracle::render_with_geometry(scene, view, stack, earlier)?;
                Ok(Capture {
                    frame,
                    geometry,
                    layers: None,
                    previous: before.map(|before| before.resolved().to_vec()),
                    shown: None,
                })
            }
            Self::Gpu(renderer, _) => {
                renderer.set_scene(scene).block_on()?;
                Ok(renderer
                    .capture_last(&moments, &preset.accuracy)
                    .block_on()?)
            }
        }
    }
}

/// AccuracyOptions that an adapter of these capabilities has.
pub fn usable_options(caps: &Caps) -> Vec<Visibility> {
    Visibility::EXACT
        .into_iter()
        .filter(|option| option.is_supported(caps.int64_atomics))
        .collect()
}

pub fn describe(summary: &AdapterSummary, caps: &Caps) -> String {
    let software = if summary.software {
        ", software; compare its timings only with those of software adapters"
    } else {
        ""
    };
    format!(
        "{} ({}, {}, {}{software})",
        summary.name,
        summary.backend,
        summary.driver,
        caps.class()
    )
}

pub fn adapter_json(summary: &AdapterSummary, caps: &Caps) -> Value {
    json!({
        "name": summary.name, "backend": summary.backend, "driver": summary.driver,
        "software": summary.software, "class": caps.class(),
    })
}

/// The scene of a preset, which then has what it [takes from it](PresetFile::settle). Warns of scopes
/// that match no part of it.
pub fn scene_of(
    common: &Common,
    preset_file: &mut PresetFile,
    streams: &Streams,
) -> Result<Arc<Scene>, CliError> {
    let (scene, warnings) = loading::watched(streams, || scene_with_warnings(common, preset_file))?;
    warnings
        .iter()
        .for_each(|warning| streams.note(&format!("warning: {warning}")));
    Ok(scene)
}

/// Errors: the model of a preset is missing, which is said before what is wrong with the output.
pub fn check_model(preset_file: &PresetFile) -> Result<(), CliError> {
    preset_file::check_model(&preset_file.preset, preset_file.path.as_deref())
        .map_err(|error| CliError::from(error).during(format!("preset {}", preset_file.id)))
}

/// Tells what a person should know of the scene of a picture.
pub fn tell(preset: &Preset, scene: &Scene, streams: &Streams) {
    scene.notes.iter().for_each(|note| streams.note(note));
    for enabled in &preset.stack.0 {
        if let Some(why) = enabled.effect.why_idle(scene) {
            streams.note(&format!("info: {}: {why}", enabled.effect.name));
        }
    }
    if let Some(camera) = preset.cropping_camera(scene) {
        let name = legible_line(&camera.name);
        streams.note(&format!(
            "info: the file's camera {name} leaves out some of the model; --set 'scene.camera={NO_CAMERA}' shows all of it"
        ));
    }
    if preset.view(scene, preset.output.size).precision.is_relative {
        streams.note(
            "info: the scene lies far from its origin, so positions are taken relative to the eye",
        );
    }
}

/// [`scene_of`], with the warnings.
pub fn scene_with_warnings(
    common: &Common,
    preset_file: &mut PresetFile,
) -> Result<(Arc<Scene>, Vec<String>), CliError> {
    let scene = preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref())
        .map_err(|e| CliError::from(e).during(format!("preset {}", preset_file.id)))?;
    if let (Some(fault), true) = (scene.faults.first(), common.strict) {
        return Err(CliError::usage(format!("{}: {fault}", scene.name))
            .during(format!("preset {}", preset_file.id)));
    }
    let is_lit = common
        .set
        .iter()
        .any(|set| set.trim_start().starts_with("studio.lights"));
    preset_file.settle(&scene, !is_lit);
    let file = preset_file.path.as_ref().map_or_else(
        || format!("{}.toml", preset_file.id),
        |path| path.display().to_string(),
    );
    let warnings: Vec<String> = preset_file
        .preset
        .missing_parts(&scene)
        .iter()
        .map(|missing| format!("{file}: {missing}"))
        .collect();
    match common.strict && !warnings.is_empty() {
        true => Err(PresetError::Strict(warnings).into()),
        false => Ok((scene, warnings)),
    }
}
