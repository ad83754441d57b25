//! `bench`: time and error, one row per scene and option. Every row with a time has an error.

use std::sync::Arc;

use serde_json::Value;

use super::{
    args::{Bench, Common, Format},
    backend::{Backend, scene_of},
    error::{CliError, Exit},
    open,
    streams::{Streams, table},
    sweep,
};
use crate::{
    effects::{EFFECTS, EnabledEffect, Stack},
    gpu::{
        Capture,
        bench::{BenchOptions, BenchRow, bench, bench_stacks},
    },
    measure::Verdict,
    oracle,
    preset::SceneSource,
    preset_file::PresetFile,
    scene::{Scene, view::View},
};

pub fn run(common: &Common, args: &Bench, streams: &mut Streams) -> Result<Exit, CliError> {
    if !args.axes.is_empty() {
        return sweep::run(common, args, streams);
    }
    let subjects = subjects(common, args)?;
    let backend = Backend::open(common, streams)?;
    let Backend::Gpu(_, gpu) = &backend else {
        return Err(CliError::usage("bench needs a GPU adapter; the oracle is not measured"));
    };
    let options = BenchOptions { size: args.size, samples: args.samples as usize };
    let bar = streams.progress(0);
    let mut rows = Vec::new();
    for (preset_file, scene) in &subjects {
        let preset = &preset_file.preset.evaluated();
        let view = preset.view(scene, args.size);
        let judge = judge(scene, &view);
        let mut progress = |what: &str, done: usize, all: usize| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
            bar.set_message(what.to_owned());
        };
        rows.extend(match args.effects {
            true => bench_stacks(gpu, preset, scene, &each_effect(common)?, &options, &mut progress, &judge)?,
            false => bench(gpu, preset, scene, &preset_file.id, &options, &mut progress, &judge)?,
        });
    }
    bar.finish_and_clear();
    let results = || rows.iter().map(serde_json::to_value).collect::<Result<Vec<Value>, _>>().map_err(CliError::usage);
    present(args, streams, &backend, &lines(&rows), results)?;
    rows.iter().filter_map(|row| row.note.as_ref()).for_each(|note| streams.note(note));
    let broken: Vec<_> = rows.iter().filter(|row| row.is_promised && !row.error.is_exact()).collect();
    broken.iter().for_each(|row| streams.note(&format!("{} with {}: the picture is not exact", row.scene, row.option)));
    Ok(Exit::failed_if(!broken.is_empty()))
}

/// Compares what an adapter drew of `scene` through `view` with the oracle.
pub fn judge<'a>(scene: &'a Scene, view: &'a View) -> impl Fn(&Stack, &Capture) -> Verdict + use<'a> {
    move |stack, capture| oracle::judge(scene, view, stack, &capture.picture()).expect("a scene that was drawn can be judged")
}

/// Prints rows in the chosen format, and a note on how they were measured.
pub fn present(
    args: &Bench,
    streams: &mut Streams,
    backend: &Backend,
    lines: &[Vec<String>],
    results: impl FnOnce() -> Result<Vec<Value>, CliError>,
) -> Result<(), CliError> {
    let format = if streams.json { Format::Json } else { args.format };
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

/// No effect, and every effect alone with the values of the preset of its name.
fn each_effect(common: &Common) -> Result<Vec<(String, Stack)>, CliError> {
    let mut stacks = vec![("no effect".to_owned(), Stack::default())];
    for effect in EFFECTS {
        let preset_file = open(common, effect.name)?;
        let enabled = preset_file.preset.evaluated_stack().get(effect.name).cloned().unwrap_or_else(|| EnabledEffect::new(effect));
        stacks.push((format!("+{}", effect.name), Stack(vec![enabled])));
    }
    Ok(stacks)
}

/// Presets with their scenes: each preset with its own scene, or with each `--scene`.
pub fn subjects(common: &Common, args: &Bench) -> Result<Vec<(PresetFile, Arc<Scene>)>, CliError> {
    let named = args.inputs.iter().map(|what| open(common, what)).collect::<Result<Vec<_>, _>>()?;
    let mut preset_files = Vec::new();
    for scene in &args.scene {
        let mut base = open(common, &if is_model(scene) { scene.clone() } else { format!("builtin:{scene}") })?;
        if named.is_empty() {
            base.id.clone_from(scene);
            preset_files.push(base);
            continue;
        }
        preset_files.extend(named.iter().map(|preset_file| {
            let mut preset_file = preset_file.clone();
            preset_file.id = format!("{} on {scene}", preset_file.id);
            preset_file.preset.scene = base.preset.scene.clone();
            // The camera of the preset is meant for the scene of the preset.
            preset_file.preset.camera = None;
            preset_file.preset.scene_camera.clear();
            preset_file
        }));
    }
    if args.scene.is_empty() {
        preset_files = if named.is_empty() { vec![PresetFile::of_scene("teapot", SceneSource::Builtin("teapot".into()))] } else { named };
    }
    preset_files.into_iter().map(|preset_file| Ok((preset_file.clone(), scene_of(&preset_file)?))).collect()
}

fn is_model(scene: &str) -> bool {
    let lower = scene.to_lowercase();
    lower.ends_with(".glb") || lower.ends_with(".gltf")
}

fn lines(rows: &[BenchRow]) -> Vec<Vec<String>> {
    let head = ["SCENE", "TRIANGLES", "OPTION", "MS P50", "MS P95", "N", "WRONG", "SNAP", "HOLES", "DOUBLE", "MAX", "RMS", "ADAPTER"];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    // Columns for deformed vertices and particles only where there are any.
    let deforms = rows.iter().any(|row| row.error.max_deform_px.is_some());
    let before_adapter = head.len() - 1;
    if deforms {
        lines[0].insert(before_adapter, "DEFORM PX".into());
    }
    let has_particles = rows.iter().any(|row| row.error.max_divergence_px.is_some());
    if has_particles {
        lines[0].insert(before_adapter, "DIVERGED PX".into());
    }
    let not_measured = || "not measured".to_owned();
    let ms = |ms: Option<f64>| ms.map_or_else(not_measured, |ms| format!("{ms:.3}"));
    let count = |count: Option<u64>| count.map_or_else(not_measured, |count| count.to_string());
    lines.extend(rows.iter().map(|row| {
        let e = &row.error;
        let mut line = vec![
            row.scene.clone(),
            row.triangles.to_string(),
            row.option.clone(),
            ms(row.ms_p50),
            ms(row.ms_p95),
            row.samples.to_string(),
            count(e.wrong_triangles),
            count(e.explained_by_snap),
            count(e.holes),
            count(e.double_hits),
            count(e.max_color_delta.map(u64::from)),
            e.rms_color_delta.map_or_else(not_measured, |rms| format!("{rms:.4}")),
            row.adapter.clone(),
        ];
        if deforms {
            line.insert(before_adapter, e.max_deform_px.map_or_else(not_measured, |px| format!("{px:.5}")));
        }
        if has_particles {
            line.insert(before_adapter, e.max_divergence_px.map_or_else(not_measured, |px| format!("{px:.5}")));
        }
        line
    }));
    lines
}

fn csv(lines: &[Vec<String>]) -> String {
    let cell = |text: &String| if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.clone() };
    lines.iter().map(|line| format!("{}\n", line.iter().map(cell).collect::<Vec<_>>().join(","))).collect()
}

fn markdown(lines: &[Vec<String>]) -> String {
    let row = |line: &Vec<String>| format!("| {} |\n", line.join(" | "));
    let rule = format!("|{}\n", "---|".repeat(lines[0].len()));
    lines.iter().enumerate().map(|(i, line)| if i == 0 { row(line) + &rule } else { row(line) }).collect()
}
