//! `bench`: time and error, one row per scene and option. Every row with a time has an error.

use serde_json::Value;

use super::{
    args::{Bench, Common},
    backend::Backend,
    error::{CliError, Exit},
    measured::{judge, print_rows, subjects},
    open::open_alone,
    streams::Streams,
    trade,
};
use crate::{
    baselines::{BenchOptions, BenchRow, bench, bench_stacks},
    effects::{EFFECTS, EnabledEffect, Stack},
    oracle,
};

pub fn run(common: &Common, args: &Bench, streams: &mut Streams) -> Result<Exit, CliError> {
    if !args.axes.is_empty() {
        return trade::run(common, args, streams);
    }
    let subjects = subjects(common, args, streams)?;
    let backend = Backend::open(common, streams)?;
    let Backend::Gpu(_, gpu) = &backend else {
        return Err(CliError::usage(
            "bench needs a GPU adapter; the oracle is not measured",
        ));
    };
    let options = BenchOptions {
        size: args.size,
        samples: args.samples as usize,
    };
    let bar = streams.progress(0);
    let mut rows = Vec::new();
    for (preset_file, scene) in &subjects {
        let preset = &preset_file.preset.drawn_on(scene, args.size[1]);
        let view = preset.view(scene, args.size);
        let judge = judge(scene, &view);
        let mut progress = |what: &str, done: usize, all: usize| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
            bar.set_message(what.to_owned());
        };
        let stacks = if args.every_effect {
            each_effect(common)?
        } else {
            vec![(String::new(), preset.stack.clone())]
        };
        for (_, stack) in &stacks {
            let judged = oracle::can_judge(scene, &view, stack, preset.accuracy.scale().factor());
            judged.map_err(|error| {
                CliError::from(error).during(format!("preset {}", preset_file.id))
            })?;
        }
        rows.extend(match args.every_effect {
            true => bench_stacks(gpu, preset, scene, &stacks, &options, &mut progress, &judge)?,
            false => bench(
                gpu,
                preset,
                scene,
                &preset_file.id,
                &options,
                &mut progress,
                &judge,
            )?,
        });
    }
    bar.finish_and_clear();
    let results = || {
        rows.iter()
            .map(serde_json::to_value)
            .collect::<Result<Vec<Value>, _>>()
            .map_err(CliError::usage)
    };
    print_rows(args, streams, &backend, &lines(&rows), results)?;
    rows.iter()
        .filter_map(|row| row.note.as_ref())
        .for_each(|note| streams.note(note));
    let broken: Vec<_> = rows
        .iter()
        .filter(|row| row.is_promised && !row.error.is_exact())
        .collect();
    broken.iter().for_each(|row| {
        streams.note(&format!(
            "{} with {}: the picture is not exact",
            row.scene, row.option
        ))
    });
    Ok(Exit::failed_if(!broken.is_empty()))
}

/// No effect, and every effect alone with the values of the preset of its name.
fn each_effect(common: &Common) -> Result<Vec<(String, Stack)>, CliError> {
    let mut stacks = vec![("no effect".to_owned(), Stack::default())];
    for effect in EFFECTS.iter() {
        // Each effect has the values of its own preset; --preset does not change them.
        let preset_file = open_alone(common, &effect.name)?;
        let enabled = preset_file
            .preset
            .evaluated_stack()
            .get(&effect.name)
            .cloned()
            .unwrap_or_else(|| EnabledEffect::new(effect));
        stacks.push((format!("+{}", effect.name), Stack(vec![enabled])));
    }
    Ok(stacks)
}

fn lines(rows: &[BenchRow]) -> Vec<Vec<String>> {
    let head = [
        "SCENE",
        "TRIANGLES",
        "OPTION",
        "MS P50",
        "MS P95",
        "N",
        "WRONG",
        "SNAP",
        "HOLES",
        "DOUBLE",
        "MAX",
        "RMS",
        "ADAPTER",
    ];
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
            e.rms_color_delta
                .map_or_else(not_measured, |rms| format!("{rms:.4}")),
            row.adapter.clone(),
        ];
        if deforms {
            line.insert(
                before_adapter,
                e.max_deform_px
                    .map_or_else(not_measured, |px| format!("{px:.5}")),
            );
        }
        if has_particles {
            line.insert(
                before_adapter,
                e.max_divergence_px
                    .map_or_else(not_measured, |px| format!("{px:.5}")),
            );
        }
        line
    }));
    lines
}
