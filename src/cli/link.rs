//! `link`: the address under which a page draws a preset and proves that its picture has the same
//! bits as the oracle's.

use std::sync::Arc;

use serde_json::{Value, json};

use super::{
    args::{Common, Link},
    backend::scene_of,
    error::{CliError, Exit},
    open::open,
    streams::Streams,
};
use crate::{
    accuracy::AccuracyRequest,
    gpu::device::Caps,
    oracle,
    plan::Planner,
    preset::{Preset, SceneSource},
    preset_file::{self, Fnv, PresetFile, hex},
    scene::{Scene, needs::Needs},
};

pub fn run(common: &Common, args: &Link, streams: &mut Streams) -> Result<Exit, CliError> {
    let preset_file = open(common, &args.input)?;
    let scene = scene_of(common, &preset_file, streams)?;
    let line = line(&preset_file)?;
    let bits = portable_bits(&preset_file.preset, &scene);
    if let Err(why) = &bits {
        streams.note(&format!(
            "{}: the page judges its picture, but not bit by bit: {why}",
            preset_file.id
        ));
    }
    let bits = bits.ok().map(|bits| bits.join("-"));
    let proof = bits.iter().map(|bits| format!(";{bits}"));
    let link = format!("{}#{line}{}", args.page, proof.collect::<String>());
    if streams.json {
        let result = json!({ "preset": preset_file.id, "link": link, "bits": bits });
        streams.object("link", Value::Null, vec![result])?;
    } else {
        streams.text(&format!("{link}\n"))?;
    }
    Ok(Exit::Done)
}

/// The line that a page reads behind `#`.
///
/// # Errors
/// The preset shows a model, which a page cannot read from this machine.
pub fn line(preset_file: &PresetFile) -> Result<String, CliError> {
    if let SceneSource::File(model) = &preset_file.preset.scene {
        return Err(CliError::usage(format!(
            "{}: its scene is the model {}, which a page cannot read from here; choose a built-in scene (rasterlab list scenes)",
            preset_file.id,
            model.display()
        )));
    }
    Ok(preset_file::to_line(preset_file))
}

/// FNV-1a of the triangle ids and of the depth keys, which are the same bits on every adapter; or
/// why they are not.
fn portable_bits(preset: &Preset, scene: &Scene) -> Result<[String; 2], String> {
    let size = preset.output.size;
    let (view, stack) = (preset.view(scene, size), preset.stack_on(scene, size));
    let draws = stack
        .draws(scene, &view)
        .map_err(|error| error.to_string())?;
    let needs = Arc::new(Needs::of(scene, &draws, &view));
    let (caps, request) = (Caps::ALL, AccuracyRequest::portable_bits());
    Planner::default()
        .plan(&needs, &stack, &caps, &caps.tuning(), &request)
        .map_err(|error| error.to_string())?;
    let (triangle_ids, depth_keys) =
        oracle::strict_frame(scene, &view, &stack).map_err(|error| error.to_string())?;
    Ok([triangle_ids, depth_keys].map(|words| hex(Fnv::new().words(&words))))
}
