//! `sweep`: one or two values of a preset through several steps each, drawn as one contact sheet.

use std::sync::Arc;

use serde_json::json;

use super::{
    args::{Common, Sweep},
    backend::{Backend, check_model, scene_of},
    error::{CliError, Exit},
    files,
    open::open_as,
    render::names,
    streams::Streams,
};
use crate::{
    contact_sheet::{ContactSheet, Picture, size_of},
    preset::{Preset, SceneSource},
    preset_file::{
        self, PresetFile,
        sweep::{Sheet, Variation},
    },
    scene::{Ground, Scene, parts::ShownParts},
};

/// Largest side of a sheet, pixels: what the decoders of pictures and most programs take.
const MAX_SIDE: u64 = 32_768;

/// Most pixels of a sheet: 512 MiB of them.
const MAX_PIXELS: u64 = 1 << 27;

pub fn run(common: &Common, args: &Sweep, streams: &mut Streams) -> Result<Exit, CliError> {
    let to_stdout = args.output == "-";
    files::check_picture_name(&args.output)?;
    if to_stdout && streams.json {
        return Err(CliError::usage(
            "-o - writes one PNG to stdout; leave out --json",
        ));
    }
    let vary = |error: String| CliError::usage(format!("--vary {error}"));
    let variations = args
        .vary
        .iter()
        .map(|text| Variation::parse(text))
        .collect::<Result<Vec<_>, _>>()
        .map_err(vary)?;
    let mut base = open_with_flags(common, args)?;
    base.remarks()
        .iter()
        .for_each(|remark| streams.note(remark));
    let mut scene: Option<Shown> = None;
    if base.is_unsettled() {
        let loaded = scene_of(common, &mut base, streams)?;
        scene = Some(Shown::new(&base.preset, loaded));
    }
    check_model(&base)?;
    // The reader of values names --set in its errors; here the values come from --vary.
    let sheet = Sheet::new(&base, &variations)
        .map_err(|error| CliError::usage(error.replacen("--set", "--vary", 1)))?;
    let title = format!(
        "{}: {}",
        base.id,
        variations
            .iter()
            .map(|variation| variation.path.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    );
    let cell = base.preset.output.size;
    let [width, height] = size_of(sheet.columns, sheet.cells.len(), cell);
    if width.max(height) > MAX_SIDE || width * height > MAX_PIXELS {
        return Err(CliError::usage(format!(
            "the sheet would have {width}x{height} pixels, at most {MAX_SIDE} a side and {MAX_PIXELS} together; take a smaller --size or fewer \
             steps"
        )));
    }
    let mut drawn = ContactSheet::new(&title, sheet.columns, sheet.cells.len(), cell);
    let mut backend = Backend::open(common, streams)?;
    let names = names(&base, &backend);
    if !to_stdout {
        // An existing file is reported before anything is drawn.
        files::target(&args.output, &names, common.force)?;
    }
    let bar = streams.progress(sheet.cells.len() as u64);
    for (index, cell) in sheet.cells.iter().enumerate() {
        bar.set_message(cell.caption());
        let preset = &cell.preset_file.preset;
        let shown = match scene.take().filter(|shown| shown.is_of(preset)) {
            Some(shown) => shown,
            None => Shown::new(
                preset,
                scene_of(common, &mut cell.preset_file.clone(), streams)?,
            ),
        };
        let frame = backend
            .frame(preset, &shown.scene)
            .map_err(|error| error.during(cell.caption()))?;
        drawn.put(
            index,
            &Picture {
                caption: cell.caption(),
                color: frame.color,
            },
        );
        scene = Some(shown);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let png = preset_file::png_bytes(drawn.color(), drawn.size())?;
    if to_stdout {
        streams.bytes(&png)?;
        return Ok(Exit::Done);
    }
    let path = files::create(&args.output, &names, common.force, &png)?;
    if !streams.json {
        streams.text(&format!("{}\n", path.display()))?;
        return Ok(Exit::Done);
    }
    let cells = sheet.cells.iter().enumerate().map(|(index, cell)| {
        let values: serde_json::Map<_, _> = cell.values.iter().map(|(path, value)| (path.clone(), json!(value))).collect();
        json!({ "column": index % sheet.columns, "row": index / sheet.columns, "corner": drawn.corner(index), "values": values })
    });
    let result = json!({
        "preset": base.id, "file": path.to_string_lossy(), "size": drawn.size(), "cell_size": cell, "columns": sheet.columns,
        "rows": sheet.rows(), "cells": cells.collect::<Vec<_>>(),
    });
    streams.object("sweep", backend.json(), vec![result])?;
    Ok(Exit::Done)
}

/// Opens the preset with `--size`, `--time` and `--tier`, which are short for `--set`.
fn open_with_flags(common: &Common, args: &Sweep) -> Result<PresetFile, CliError> {
    let tier = args.tier.as_deref();
    let mut preset_file = open_as(common, &args.input, args.size, args.time, tier)?;
    preset_file.preset.accuracy = preset_file.preset.accuracy.anti_aliased();
    if preset_file.preset.output.size.contains(&0) {
        return Err(CliError::usage(
            "--size: a sheet needs pictures of at least 1x1 pixels",
        ));
    }
    Ok(preset_file)
}

/// The scene of the newest cell; most cells share it.
struct Shown {
    source: SceneSource,
    parts: ShownParts,
    room: f64,
    ground: Option<Ground>,
    scene: Arc<Scene>,
}

impl Shown {
    fn new(preset: &Preset, scene: Arc<Scene>) -> Self {
        Self {
            source: preset.scene.clone(),
            parts: preset.parts.clone(),
            room: preset.room,
            ground: preset.ground,
            scene,
        }
    }

    fn is_of(&self, preset: &Preset) -> bool {
        self.source == preset.scene
            && self.parts == preset.parts
            && self.room == preset.room
            && self.ground == preset.ground
    }
}
