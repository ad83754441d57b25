//! Presets that commands name, with the look of `--preset` and the changes of `--set` and
//! `--unset`.

use super::{args::Common, error::CliError, files, streams::Streams};
use crate::{
    effects::{Effect, EnabledEffect, Stack},
    params::legible_line,
    preset::Preset,
    preset_file::{self, GalleryEntry, PresetError, PresetFile},
};

/// As [`open`], with the size, the time and the tier of a picture instead of the preset's own.
pub fn open_as(
    common: &Common,
    what: &str,
    size: Option<[u32; 2]>,
    time_s: Option<f64>,
    tier: Option<&str>,
) -> Result<PresetFile, CliError> {
    let mut preset_file = open(common, what)?;
    retake(&mut preset_file, size, time_s, tier)?;
    Ok(preset_file)
}

/// Gives a preset the size, the time and the tier of a picture.
pub fn retake(
    preset_file: &mut PresetFile,
    size: Option<[u32; 2]>,
    time_s: Option<f64>,
    tier: Option<&str>,
) -> Result<(), CliError> {
    if let Some(size) = size {
        preset_file.preset.output.resize(size);
    }
    if let Some(time_s) = time_s {
        preset_file::set(preset_file, "clock.time_s", &format!("{time_s:?}"))?;
    }
    if let Some(tier) = tier {
        preset_file::set(preset_file, "accuracy.tier", tier).map_err(|error| {
            CliError::usage(
                error
                    .to_string()
                    .replacen("--set: accuracy.tier", "--tier", 1),
            )
        })?;
    }
    Ok(())
}

/// Opens a preset, puts the look of `--preset` on its scene, and applies `--unset`, then `--set`. Of
/// a picture that names a model outside of its folder only the look is taken.
pub fn open(common: &Common, what: &str) -> Result<PresetFile, CliError> {
    let mut named = read(common, what)?;
    if let Some(model) = &named.outside_model {
        let own = PresetFile::of_scene(&named.id, Preset::default().scene);
        let name = own.scene_name();
        let warning = format!(
            "{what}: its model {} lies outside of its folder, so only its look is used, on the {name}; --allow-outside opens the model",
            legible_line(&model.to_string_lossy()),
        );
        let frame = named.preset.output.size;
        let mut landed = land(common, &named, &own)?;
        landed.warnings.push(warning);
        if common.strict {
            landed = landed.strict()?;
        }
        (landed.id, landed.preset.output.size) = (named.id, frame);
        named = landed;
    }
    finish_opening(common, named)
}

/// [`open`] for the window, which asks about a model outside of its folder.
#[cfg(feature = "gui")]
pub fn open_to_ask(common: &Common, what: &str) -> Result<PresetFile, CliError> {
    finish_opening(common, read(common, what)?)
}

fn finish_opening(common: &Common, named: PresetFile) -> Result<PresetFile, CliError> {
    let preset_file = match &common.preset {
        Some(look) => land(common, &read(common, look)?, &named)?,
        None => named,
    };
    changed(common, preset_file)
}

/// Opens the preset of `--preset` with its own scene, for a command without another, and applies
/// `--unset`, then `--set`.
pub fn open_alone(common: &Common, look: &str) -> Result<PresetFile, CliError> {
    changed(common, read(common, look)?)
}

/// The scene that `what` names under the effect `lambert` and nothing else, with the changes of
/// `--unset`, then `--set`: what is measured where no preset is named.
pub fn open_bare(common: &Common, what: &str) -> Result<PresetFile, CliError> {
    let mut bare = read(common, what)?;
    let mut stack = Stack::default();
    stack.enable(Effect::named("lambert"));
    bare.preset = Preset {
        scene: bare.preset.scene,
        stack,
        ..Preset::default()
    };
    changed(common, bare)
}

/// Reads what a person names, as its file has it.
pub fn read(common: &Common, what: &str) -> Result<PresetFile, CliError> {
    let preset_file = if what == "-" {
        preset_file::parse_with(
            &files::stdin_text()?,
            "stdin",
            "stdin",
            &common.folders().effects,
        )?
    } else {
        preset_file::open(what, &common.folders())?
    };
    let preset_file = match common.allow_outside {
        true => preset_file.with_outside_model(),
        false => preset_file,
    };
    Ok(if common.strict {
        preset_file.strict()?
    } else {
        preset_file
    })
}

/// Puts a look on the scene of `own`. Both scenes are read only if the look has lengths, that of
/// `own` also if it has effects on parts.
pub fn land(common: &Common, look: &PresetFile, own: &PresetFile) -> Result<PresetFile, CliError> {
    let bounds = |preset_file: &PresetFile| {
        let PresetFile { preset, path, .. } = preset_file;
        let bounds = preset_file::scene_bounds(&preset.scene, preset.parts.up, path.as_deref());
        bounds.map_err(|error| CliError::from(error).during(format!("preset {}", preset_file.id)))
    };
    let own_scene = || {
        preset_file::load_scene(&own.preset, own.path.as_deref())
            .map_err(|error| CliError::from(error).during(format!("preset {}", own.id)))
    };
    let is_measurable = look.outside_model.is_none();
    let mut scene = None;
    let fit = if look.needs_fit() && is_measurable {
        let own_scene = &**scene.insert(own_scene()?);
        let boxes = [&bounds(look)?, &own_scene.content_bounds()];
        look.fit_to(own, boxes, Some(own_scene))
    } else {
        None
    };
    let mut landed = look.landed_on(own, fit.as_ref());
    if look.needs_fit() && !is_measurable {
        landed.warnings.push(format!(
            "{}: the model of the look lies outside of its folder and is not read, so its lengths stay as they are; --allow-outside opens it",
            landed.title()
        ));
    }
    let is_limited = |enabled: &EnabledEffect| !enabled.on.is_whole_scene();
    if landed.preset.stack.0.iter().any(is_limited) {
        let scene = match scene {
            Some(scene) => scene,
            None => own_scene()?,
        };
        landed.map_missing_parts(&scene);
    }
    if common.strict && !landed.warnings.is_empty() {
        return Err(PresetError::Strict(landed.warnings).into());
    }
    landed
        .warnings
        .splice(0..0, look.warnings.iter().chain(&own.warnings).cloned());
    Ok(landed)
}

/// Applies `--unset`, then `--set`.
fn changed(common: &Common, mut preset_file: PresetFile) -> Result<PresetFile, CliError> {
    for path in &common.unset {
        preset_file::unset(&mut preset_file, path)?;
    }
    for set in &common.set {
        let (path, value) = set.split_once('=').unwrap_or((set, ""));
        preset_file::set(&mut preset_file, path.trim(), value)?;
    }
    if !(common.set.is_empty() && common.unset.is_empty()) {
        preset_file.check_values()?;
    }
    Ok(preset_file)
}

/// The named presets, or every preset of the gallery that has a golden; without names, `--preset`
/// is the one.
pub fn presets(
    common: &Common,
    names: &[String],
    streams: &Streams,
) -> Result<Vec<PresetFile>, CliError> {
    let preset_files: Vec<PresetFile> = match (names, &common.preset) {
        ([], Some(look)) => vec![open_alone(common, look)?],
        ([], None) => {
            let entries = preset_file::gallery(&common.folders());
            let preset_files = entries
                .iter()
                .map(|entry| open(common, &gallery_name(entry)))
                .collect::<Result<Vec<_>, _>>()?;
            preset_files
                .into_iter()
                .filter(|preset_file| preset_file.preset.test.is_some())
                .collect()
        }
        (names, _) => names
            .iter()
            .map(|name| presets_at(common, name))
            .collect::<Result<Vec<_>, _>>()?
            .concat(),
    };
    preset_files
        .iter()
        .flat_map(PresetFile::remarks)
        .for_each(|remark| streams.note(&remark));
    Ok(preset_files)
}

/// What a person names: a preset, or a folder and every preset in it.
fn presets_at(common: &Common, name: &str) -> Result<Vec<PresetFile>, CliError> {
    let error = match open(common, name) {
        Ok(preset_file) => return Ok(vec![preset_file]),
        Err(error) => error,
    };
    let Ok(entries) = std::fs::read_dir(name) else {
        return Err(error);
    };
    let mut paths: Vec<_> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    paths.sort();
    let preset_files = paths
        .iter()
        .map(|path| open(common, &path.to_string_lossy()));
    preset_files.collect()
}

/// What a JSON object says of a preset: its id, and where a look has landed, the look and the
/// scene.
pub fn named(preset_file: &PresetFile, mut object: serde_json::Value) -> serde_json::Value {
    object["preset"] = preset_file.id.clone().into();
    if let Some(look) = &preset_file.look {
        object["look"] = look.id.clone().into();
        object["model"] = preset_file.scene_name().into();
    }
    object
}

/// The path of a preset on disk, or the id of a built-in one.
pub fn gallery_name(entry: &GalleryEntry) -> String {
    entry.path.as_ref().map_or_else(
        || entry.id.clone(),
        |path| path.to_string_lossy().into_owned(),
    )
}
