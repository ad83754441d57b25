//! `render`: one picture of each preset, and arrays of its triangle ids and depths.

use std::path::PathBuf;

use serde_json::json;

use super::{
    args::{Common, Render},
    arrays,
    backend::{Backend, check_model, scene_of, scene_with_warnings, tell},
    error::{CliError, Exit},
    files::{self, Names},
    open::{named, open, retake},
    streams::Streams,
};
use crate::{
    frame::Frame,
    preset_file::{self, PresetFile},
    scene::Scene,
};

pub fn run(common: &Common, args: &Render, streams: &mut Streams) -> Result<Exit, CliError> {
    check_names(args, streams)?;
    let to_stdout = args.output == "-";
    let mut preset_files = args
        .inputs
        .iter()
        .map(|what| open_with_flags(common, args, what))
        .collect::<Result<Vec<_>, _>>()?;
    preset_files
        .iter()
        .flat_map(PresetFile::remarks)
        .for_each(|remark| streams.note(&remark));
    preset_files.iter().try_for_each(check_model)?;
    let mut backend = Backend::open(common, streams)?;
    // Existing files are reported before anything is drawn.
    let picture = (!to_stdout).then_some(&args.output);
    for (template, preset_file) in [picture, args.triangle_ids.as_ref(), args.depths.as_ref()]
        .into_iter()
        .flatten()
        .flat_map(|template| preset_files.iter().map(move |file| (template, file)))
    {
        files::target(template, &names(preset_file, &backend), common.force)?;
    }
    let bar = streams.progress(preset_files.len() as u64);
    let mut results = Vec::new();
    for preset_file in &mut preset_files {
        bar.set_message(preset_file.id.clone());
        let scene = scene_of(common, preset_file, streams)?;
        let preset_file = &*preset_file;
        tell(&preset_file.preset, &scene, streams);
        let frame = backend.frame(&preset_file.preset, &scene)?;
        let names = names(preset_file, &backend);
        let saved = if to_stdout {
            preset_file.clone()
        } else {
            preset_file.for_picture(&files::target(&args.output, &names, common.force)?)
        };
        let png = if args.bare {
            preset_file::png_bytes(&frame.color, [frame.width, frame.height])?
        } else {
            preset_file::png_with_preset(&frame, &saved, &backend.provenance())?
        };
        bar.inc(1);
        if to_stdout {
            write_arrays(common, args, preset_file, &scene, &frame, &names)?;
            streams.bytes(&png)?;
            continue;
        }
        let mut written = vec![(
            "file",
            files::create(&args.output, &names, common.force, &png)?,
        )];
        written.extend(write_arrays(
            common,
            args,
            preset_file,
            &scene,
            &frame,
            &names,
        )?);
        let mut result = json!({ "size": [frame.width, frame.height], "covered": frame.covered(), "counters": frame.counters });
        for (what, path) in &written {
            result[what] = path.to_string_lossy().into();
            if !streams.json {
                streams.text(&format!("{}\n", path.display()))?;
            }
        }
        results.push(named(preset_file, result));
    }
    bar.finish_and_clear();
    if streams.json {
        streams.object("render", backend.json(), results)?;
    }
    Ok(Exit::Done)
}

/// Errors: a name that is no picture's, or that several presets would share.
fn check_names(args: &Render, streams: &Streams) -> Result<(), CliError> {
    let to_stdout = args.output == "-";
    files::check_picture_name(&args.output)?;
    if to_stdout && (streams.json || args.inputs.len() > 1) {
        return Err(CliError::usage(
            "-o - writes one PNG to stdout; leave out --json and name one preset",
        ));
    }
    if args.inputs.len() > 1
        && !(files::has_preset(&args.output)? || files::has_number(&args.output)?)
    {
        return Err(CliError::usage(format!(
            "{}: put {{preset}} or {{n}} into the name, since there are several presets",
            args.output
        )));
    }
    check_arrays(args)
}

/// The arrays beside the picture, each with its key in `--json` and its path.
fn write_arrays(
    common: &Common,
    args: &Render,
    preset_file: &PresetFile,
    scene: &Scene,
    frame: &Frame,
    names: &Names,
) -> Result<Vec<(&'static str, PathBuf)>, CliError> {
    let mut written = Vec::new();
    if let Some(template) = &args.triangle_ids {
        written.push((
            "triangle_ids",
            files::create(template, names, common.force, &arrays::triangle_ids(frame))?,
        ));
    }
    if let Some(template) = &args.depths {
        let view = preset_file
            .preset
            .view(scene, preset_file.preset.output.size);
        written.push((
            "depths",
            files::create(template, names, common.force, &arrays::depths(frame, &view))?,
        ));
    }
    Ok(written)
}

/// Refuses names of arrays that cannot hold one array for each preset.
fn check_arrays(args: &Render) -> Result<(), CliError> {
    let arrays = [
        ("--triangle-ids", &args.triangle_ids),
        ("--depths", &args.depths),
    ];
    let mut taken = vec![("-o", &args.output)];
    for (flag, template) in arrays
        .iter()
        .filter_map(|(flag, template)| Some((*flag, template.as_ref()?)))
    {
        if template == "-" {
            return Err(CliError::usage(format!(
                "{flag} -: arrays are written to files; name one, such as {{preset}}.npy"
            )));
        }
        if args.inputs.len() > 1 && !(files::has_preset(template)? || files::has_number(template)?)
        {
            return Err(CliError::usage(format!(
                "{flag} {template}: put {{preset}} or {{n}} into the name, since there are several presets"
            )));
        }
        if let Some((other, _)) = taken.iter().find(|(_, name)| *name == template) {
            return Err(CliError::usage(format!(
                "{flag} {template}: {other} names the same file; give each its own"
            )));
        }
        taken.push((flag, template));
    }
    Ok(())
}

/// Opens a preset, on the way to that of `--toward`, from its `--bookmark`, with `--size`, `--time` and `--tier`, which are short for `--set`.
fn open_with_flags(common: &Common, args: &Render, what: &str) -> Result<PresetFile, CliError> {
    let mut preset_file = open(common, what)?;
    if let Some(other) = &args.toward {
        let (scene, _) = scene_with_warnings(common, &mut preset_file)?;
        preset_file = preset_file
            .toward(&open(common, other)?, args.by, &scene)
            .map_err(CliError::usage)?;
    }
    if let Some(name) = &args.bookmark {
        let camera = preset_file.preset.bookmark(name).map_err(|reason| {
            CliError::usage(format!("--bookmark: {}: {reason}", preset_file.id))
        })?;
        preset_file.preset.camera = Some(camera);
    }
    retake(&mut preset_file, args.size, args.time, args.tier.as_deref())?;
    if !args.bare {
        preset_file.check_savable()?;
    }
    // Arrays have one sample for each pixel, and the picture beside them shows the same.
    if args.triangle_ids.is_none() && args.depths.is_none() {
        preset_file.preset.accuracy = preset_file.preset.accuracy.anti_aliased();
    }
    Ok(preset_file)
}

pub fn names(preset_file: &PresetFile, backend: &Backend) -> Names {
    let effects: Vec<_> = preset_file
        .preset
        .stack
        .0
        .iter()
        .map(|enabled| enabled.effect.name.as_str())
        .collect();
    Names {
        preset: preset_file.id.clone(),
        effect: if effects.is_empty() {
            "plain".into()
        } else {
            effects.join("+")
        },
        adapter: backend.name().into(),
        tier: preset_file.preset.accuracy.tier.name().into(),
        frame: None,
    }
}
