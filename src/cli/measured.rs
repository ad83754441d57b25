//! What `bench` and `bench --axes` share: the measured presets, the judge, and the output of rows.

use std::{path::Path, sync::Arc};

use serde_json::Value;

use super::{
    args::{Bench, Common, Format},
    backend::{Backend, scene_of},
    error::CliError,
    open::{land, open, open_bare},
    streams::{Streams, table},
};
use crate::{
    effects::Stack,
    gpu::Capture,
    measure::Verdict,
    oracle,
    preset_file::{ModelFormat, PresetFile},
    scene::{Scene, view::View},
};

/// Presets with their scenes: each preset with its own scene, or with each `--scene`.
pub fn subjects(
    common: &Common,
    args: &Bench,
    streams: &Streams,
) -> Result<Vec<(PresetFile, Arc<Scene>)>, CliError> {
    let named = args
        .inputs
        .iter()
        .map(|what| open(common, what))
        .collect::<Result<Vec<_>, _>>()?;
    let mut preset_files = Vec::new();
    for scene in &args.scene {
        let what = match ModelFormat::of(Path::new(scene)) {
            Some(_) => scene.clone(),
            None => format!("builtin:{scene}"),
        };
        if named.is_empty() && common.preset.is_none() {
            let mut bare = open_bare(common, &what)?;
            bare.id.clone_from(scene);
            preset_files.push(bare);
            continue;
        }
        let mut base = open(common, &what)?;
        if named.is_empty() {
            base.id.clone_from(scene);
            preset_files.push(base);
            continue;
        }
        for preset_file in &named {
            let id = format!("{} on {scene}", preset_file.id);
            let mut landed = land(common, preset_file, &base)?;
            landed.id = id;
            preset_files.push(landed);
        }
    }
    if args.scene.is_empty() {
        preset_files = if named.is_empty() {
            vec![open_bare(common, "builtin:teapot")?]
        } else {
            named
        };
    }
    preset_files
        .into_iter()
        .map(|mut preset_file| {
            let scene = scene_of(common, &mut preset_file, streams)?;
            Ok((preset_file, scene))
        })
        .collect()
}

/// Compares what an adapter drew of `scene` through `view` with the oracle.
pub fn judge<'a>(
    scene: &'a Scene,
    view: &'a View,
) -> impl Fn(&Stack, &Capture) -> Verdict + use<'a> {
    move |stack, capture| {
        oracle::judge(scene, view, stack, &capture.picture())
            .expect("a scene that was drawn can be judged")
    }
}

/// A column of a table of measurements: its head, whether there is anything to show in it, and the
/// cell of a row.
pub type Column<Row> = (&'static str, bool, fn(&Row) -> String);

/// Heads and rows of the columns that show something.
pub fn lines<Row>(rows: &[Row], columns: &[Column<Row>]) -> Vec<Vec<String>> {
    let columns: Vec<_> = columns.iter().filter(|column| column.1).collect();
    let head = columns.iter().map(|column| column.0.to_owned()).collect();
    let line = |row| columns.iter().map(|column| (column.2)(row)).collect();
    std::iter::once(head).chain(rows.iter().map(line)).collect()
}

/// A figure with so many digits, or that there is none.
pub fn figure(figure: Option<f64>, digits: usize) -> String {
    figure.map_or_else(
        || "not measured".into(),
        |figure| format!("{figure:.digits$}"),
    )
}

/// The JSON of each row.
pub fn json_rows<Row: serde::Serialize>(rows: &[Row]) -> Result<Vec<Value>, CliError> {
    rows.iter()
        .map(serde_json::to_value)
        .collect::<Result<_, _>>()
        .map_err(CliError::usage)
}

/// Prints rows in the chosen format, and a note on how they were measured.
pub fn print_rows(
    args: &Bench,
    streams: &mut Streams,
    backend: &Backend,
    lines: &[Vec<String>],
    results: impl FnOnce() -> Result<Vec<Value>, CliError>,
) -> Result<(), CliError> {
    let format = if streams.json {
        Format::Json
    } else {
        args.format
    };
    match format {
        Format::Json => streams.object("bench", backend.json(), results()?)?,
        Format::Table => streams.text(&table(lines))?,
        Format::Csv => streams.text(&csv(lines))?,
        Format::Md => streams.text(&markdown(lines))?,
    }
    let [width, height] = args.size;
    streams.note(&format!("{width}x{height} pixels; clocks are not locked; GPU time by timestamps where the adapter has them"));
    Ok(())
}

fn csv(lines: &[Vec<String>]) -> String {
    let cell = |text: &String| {
        if text.contains([',', '"', '\n']) {
            format!("\"{}\"", text.replace('"', "\"\""))
        } else {
            text.clone()
        }
    };
    lines
        .iter()
        .map(|line| format!("{}\n", line.iter().map(cell).collect::<Vec<_>>().join(",")))
        .collect()
}

fn markdown(lines: &[Vec<String>]) -> String {
    let row = |line: &Vec<String>| format!("| {} |\n", line.join(" | "));
    let rule = format!("|{}\n", "---|".repeat(lines[0].len()));
    lines
        .iter()
        .enumerate()
        .map(|(i, line)| if i == 0 { row(line) + &rule } else { row(line) })
        .collect()
}
