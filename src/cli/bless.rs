//! `bless`: redraws goldens with the oracle and prints what changes. Only this command writes
//! goldens.

use std::{path::Path, sync::Arc};

use serde_json::{Value, json};

use super::{
    args::{Bless, Common},
    backend::scene_of,
    error::{CliError, Exit},
    open::open,
    streams::Streams,
};
use crate::{
    effects::Effect,
    golden::{self, Change, Golden},
    preset::{GoldenTest, Output, Preset},
    preset_file::{self, PresetError, PresetFile, golden_folder},
};

pub fn run(common: &Common, args: &Bless, streams: &mut Streams) -> Result<Exit, CliError> {
    let preset_files = preset_files(common, args, streams)?;
    let bar = streams.progress(preset_files.len() as u64);
    let (mut results, mut changed) = (Vec::new(), false);
    for (mut preset_file, writes) in preset_files {
        bar.set_message(preset_file.id.clone());
        let scene = scene_of(common, &mut preset_file, streams)?;
        let golden = golden::draw(&preset_file, &scene).map_err(CliError::usage)?;
        let snapshots = args
            .snapshots
            .clone()
            .unwrap_or_else(|| golden_folder(&preset_file));
        let change = change(&golden, &snapshots, &preset_file.id);
        changed |= writes.is_some() || change["changes"] == json!(true);
        if !streams.json {
            streams.text(&format!(
                "{}{}\n",
                line(&preset_file.id, &change),
                match writes {
                    Some(Writes::Preset) => " (its preset is created, too)",
                    Some(Writes::Test) => " (its preset gets a [test] table)",
                    None => "",
                }
            ))?;
        }
        if !args.dry_run {
            store(
                preset_file,
                writes,
                &golden,
                &snapshots,
                change["changes"] == json!(true),
            )?;
        }
        results.push(change);
        bar.inc(1);
    }
    bar.finish_and_clear();
    if streams.json {
        streams.object(
            "bless",
            json!({ "name": "cpu", "class": "oracle" }),
            results,
        )?;
    }
    Ok(Exit::failed_if(args.dry_run && changed))
}

/// What blessing writes beside a golden.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Writes {
    /// The first preset of an effect.
    Preset,
    /// The table `[test]` of a preset that has none.
    Test,
}

/// The presets to bless, each with what is written beside its golden: those that are named, or every preset in a
/// file that has a golden.
fn preset_files(
    common: &Common,
    args: &Bless,
    streams: &Streams,
) -> Result<Vec<(PresetFile, Option<Writes>)>, CliError> {
    if !args.all && args.names.is_empty() {
        return Err(CliError::usage("name presets or effects, or use --all"));
    }
    if !args.all {
        return args
            .names
            .iter()
            .map(|name| find_preset(common, name))
            .collect();
    }
    let entries = preset_file::gallery(&common.folders());
    let preset_files = entries
        .into_iter()
        .filter(|entry| entry.path.is_some())
        .map(|entry| Ok(entry.preset_file?.strict()?))
        .collect::<Result<Vec<_>, CliError>>()?;
    let (tested, bare): (Vec<_>, Vec<_>) = preset_files
        .into_iter()
        .partition(|preset_file| preset_file.preset.test.is_some());
    bare.iter().for_each(|preset_file| {
        streams.note(&format!(
            "{}: has no [test] table and so no golden",
            preset_file.id
        ))
    });
    Ok(tested
        .into_iter()
        .map(|preset_file| (preset_file, None))
        .collect())
}

/// The preset that every command finds under `name`, whose file gets a table `[test]` if it has
/// none; or the first one of an effect, which is new.
fn find_preset(common: &Common, name: &str) -> Result<(PresetFile, Option<Writes>), CliError> {
    let error = match open(common, name) {
        Ok(preset_file) => {
            let mut preset_file = preset_file.strict()?;
            let is_untested = preset_file.preset.test.is_none()
                && preset_file.path.is_some()
                && !preset_file.read_only;
            if is_untested {
                preset_file.preset.test = Some(GoldenTest::default());
            }
            return Ok((preset_file, is_untested.then_some(Writes::Test)));
        }
        Err(error) => error,
    };
    let is_unknown = matches!(
        error.error.downcast_ref(),
        Some(PresetError::NoPreset { .. })
    );
    match common.folders().effects.find(name) {
        Ok(Some(effect)) if is_unknown => {
            let preset_file = first_preset(effect, &common.presets_folder());
            Ok((preset_file, Some(Writes::Preset)))
        }
        _ if is_unknown => Err(CliError::usage(format!(
            "there is no preset and no effect {name:?}; rasterlab list shows all of them"
        ))),
        _ => Err(error),
    }
}

/// The first preset of a new effect, to be saved in `folder`: on the teapot, with default parameters.
fn first_preset(effect: &Arc<Effect>, folder: &Path) -> PresetFile {
    let mut preset = Preset {
        name: effect.name.replace('_', " "),
        about: effect.about.clone(),
        tags: vec!["canonical".into()],
        output: Output {
            size: golden::MAX_SIZE,
            ..Output::default()
        },
        test: Some(GoldenTest::default()),
        ..Preset::default()
    };
    preset.stack.enable(effect);
    let mut preset_file = PresetFile::new(&effect.name, preset);
    preset_file.path = Some(folder.join(format!("{}.toml", effect.name)));
    preset_file
}

fn store(
    mut preset_file: PresetFile,
    writes: Option<Writes>,
    golden: &Golden,
    snapshots: &Path,
    changes: bool,
) -> Result<(), CliError> {
    if let (Some(_), Some(path)) = (writes, preset_file.path.clone()) {
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new("")))?;
        preset_file::save(&mut preset_file, &path)?;
    }
    if changes {
        golden::store(golden, snapshots, &preset_file.id).map_err(CliError::usage)?;
    }
    Ok(())
}

/// What blessing would change, with old and new counts.
fn change(golden: &Golden, snapshots: &Path, id: &str) -> Value {
    let change = Change::of(golden, snapshots, id);
    let delta = change.delta.as_ref();
    json!({
        "preset": id, "changes": !change.is_none(), "is_new": change.stored.is_none(),
        "pixels": golden.frame.color.len(),
        "pixels_changed": delta.map(|delta| delta.pixels_over_tolerance),
        "max_color_delta": delta.map(|delta| delta.max_delta),
        "covered_old": change.sidecar["covered"], "covered_new": golden.frame.covered(),
        "bytes": golden.png.len(),
    })
}

fn line(id: &str, change: &Value) -> String {
    if change["changes"] == json!(false) {
        return format!(
            "{id}: unchanged, {} of {} pixels covered",
            change["covered_new"], change["pixels"]
        );
    }
    if change["is_new"] == json!(true) {
        return format!(
            "{id}: new, {} of {} pixels covered, {} bytes",
            change["covered_new"], change["pixels"], change["bytes"]
        );
    }
    let [old, new] = [&change["covered_old"], &change["covered_new"]];
    match (&change["pixels_changed"], &change["max_color_delta"]) {
        (Value::Null, _) => format!("{id}: another size; covered {old} -> {new}"),
        (pixels, delta) => {
            format!(
                "{id}: {pixels} of {} pixels change, at most by {delta} of 255; covered {old} -> {new}",
                change["pixels"]
            )
        }
    }
}
