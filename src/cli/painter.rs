//! Painter: whoever draws, an adapter or the oracle, behind one door.

use std::sync::Arc;

use serde_json::{Value, json};

use super::{args::Common, fault::Fault, streams::Streams};
use crate::{
    frame::{Frame, Geometry},
    gpu::{
        Capture, Gpu, Renderer,
        device::{AdapterChoice, AdapterSummary, Caps},
    },
    oracle,
    preset::{Preset, Visibility},
    preset_file::{self, PresetFile, Provenance},
    scene::{Scene, draw::draws},
};

/// Which painter was asked for.
pub enum Wanted {
    Cpu,
    Gpu(AdapterChoice),
}

/// What `--adapter` or the environment says; `cpu` is reserved.
pub fn wanted(common: &Common) -> Wanted {
    match common.adapter_name() {
        Some(name) if name.eq_ignore_ascii_case("cpu") => Wanted::Cpu,
        Some(name) => Wanted::Gpu(AdapterChoice::Named(name)),
        None => Wanted::Gpu(AdapterChoice::Any),
    }
}

/// Draws looks.
pub enum Painter {
    /// The built-in oracle; needs no driver.
    Cpu,
    Gpu(Box<Renderer>, Arc<Gpu>),
}

impl Painter {
    /// Opens what was asked for and says on stderr what it is. Nothing falls back unasked.
    pub fn open(common: &Common, streams: &Streams) -> Result<Self, Fault> {
        let painter = match wanted(common) {
            Wanted::Cpu => Self::Cpu,
            Wanted::Gpu(choice) => {
                let gpu = Gpu::open(&choice)?;
                Self::Gpu(Box::new(Renderer::new(gpu.clone())), gpu)
            }
        };
        streams.note(&format!("adapter: {}", painter.describe()));
        Ok(painter)
    }

    fn describe(&self) -> String {
        match self {
            Self::Cpu => "cpu (the built-in oracle)".into(),
            Self::Gpu(_, gpu) => describe(&gpu.summary, &gpu.caps),
        }
    }

    /// Name of the adapter, or `cpu`.
    pub fn name(&self) -> &str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu(_, gpu) => &gpu.summary.name,
        }
    }

    /// What a saved picture says about who made it.
    pub fn provenance(&self) -> Provenance {
        let driver = match self {
            Self::Cpu => format!("oracle {}", env!("CARGO_PKG_VERSION")),
            Self::Gpu(_, gpu) => format!("{} ({})", gpu.summary.driver, gpu.summary.backend),
        };
        Provenance { adapter: self.name().into(), driver }
    }

    /// The `adapter` of a JSON object.
    pub fn json(&self) -> Value {
        match self {
            Self::Cpu => {
                json!({ "name": "cpu", "backend": "cpu", "driver": self.provenance().driver, "software": true, "class": "oracle" })
            }
            Self::Gpu(_, gpu) => adapter_json(&gpu.summary, &gpu.caps),
        }
    }

    /// `native-int64`, `portable` or `oracle`.
    pub fn class(&self) -> &'static str {
        match self {
            Self::Cpu => "oracle",
            Self::Gpu(_, gpu) => gpu.caps.class(),
        }
    }

    /// Visibility options this painter can draw `session` with: the pinned one, or all that the adapter has.
    pub fn options(&self, preset: &Preset) -> Vec<Option<Visibility>> {
        match (self, preset.accuracy.pins.option::<Visibility>()) {
            (Self::Cpu, _) => vec![None],
            (_, Some(pinned)) => vec![Some(pinned)],
            (Self::Gpu(_, gpu), None) => usable_options(&gpu.caps).into_iter().map(Some).collect(),
        }
    }

    /// The picture of `session`.
    pub fn frame(&mut self, preset: &Preset, scene: &Arc<Scene>) -> Result<Frame, Fault> {
        preset.stack.check()?;
        match self {
            Self::Cpu => Ok(oracle::render_scaled(scene, &preset.moments(scene, preset.output.size), preset.accuracy.scale().factor())?),
            Self::Gpu(..) => Ok(self.capture(preset, scene)?.into_shown()),
        }
    }

    /// The picture with everything that a judge needs.
    pub fn capture(&mut self, preset: &Preset, scene: &Arc<Scene>) -> Result<Capture, Fault> {
        preset.stack.check()?;
        let moments = preset.moments(scene, preset.output.size);
        match self {
            Self::Cpu => {
                let ((view, stack), before) = moments.split_last().expect("a preset shows a moment");
                let previous = if before.is_empty() { None } else { Some(oracle::render_sequence(scene, before)?.color) };
                let frame = oracle::render_next(scene, view, stack, previous.as_deref())?;
                let geometry: Geometry = oracle::project_moved(scene, &draws(scene, view)?, view, stack);
                Ok(Capture { frame, geometry, layers: None, previous, shown: None })
            }
            Self::Gpu(renderer, _) => {
                renderer.set_scene(scene)?;
                Ok(renderer.capture_last(&moments, &preset.accuracy)?)
            }
        }
    }
}

/// AccuracyOptions that an adapter of these capabilities has.
pub fn usable_options(caps: &Caps) -> Vec<Visibility> {
    Visibility::EXACT.into_iter().filter(|option| option.is_there(caps.int64_atomics)).collect()
}

pub fn describe(summary: &AdapterSummary, caps: &Caps) -> String {
    let software = if summary.software { ", software: its times say nothing about a graphics card" } else { "" };
    format!("{} ({}, {}, {}{software})", summary.name, summary.backend, summary.driver, caps.class())
}

pub fn adapter_json(summary: &AdapterSummary, caps: &Caps) -> Value {
    json!({
        "name": summary.name, "backend": summary.backend, "driver": summary.driver,
        "software": summary.software, "class": caps.class(),
    })
}

/// The scene of a preset.
pub fn scene_of(preset_file: &PresetFile) -> Result<Arc<Scene>, Fault> {
    preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref())
        .map_err(|e| Fault::from(e).during(format!("look {}", preset_file.id)))
}
