//! `bench`: time and error, one row per scene and option. Every row with a time has an error.

use super::{
    args::{Bench, Common},
    backend::Backend,
    error::{CliError, Exit},
    measured::{self, Column, figure, json_rows, judge, print_rows, subjects},
    open::open_alone,
    streams::Streams,
    trade,
};
use crate::{
    baselines::{BenchOptions, BenchRow, Judge, bench, bench_stacks},
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
        let scale = preset.accuracy.scale().factor();
        let mut judged = stacks
            .iter()
            .map(|(_, stack)| oracle::can_judge(scene, &view, stack, scale));
        let unjudged = judged.find_map(Result::err);
        if let Some(error) = &unjudged {
            let id = &preset_file.id;
            streams.note(&format!("preset {id}: no error is measured: {error}"));
        }
        let judge: Judge = if unjudged.is_none() {
            Some(&judge)
        } else {
            None
        };
        rows.extend(match args.every_effect {
            true => bench_stacks(gpu, preset, scene, &stacks, &options, &mut progress, judge)?,
            false => bench(
                gpu,
                preset,
                scene,
                &preset_file.id,
                &options,
                &mut progress,
                judge,
            )?,
        });
    }
    bar.finish_and_clear();
    print_rows(args, streams, &backend, &lines(&rows), || json_rows(&rows))?;
    rows.iter()
        .filter_map(|row| row.note.as_ref())
        .for_each(|note| streams.note(note));
    let broken: Vec<_> = rows
        .iter()
        .filter(|row| {
            row.is_promised && row.error.wrong_triangles.is_some() && !row.error.is_exact()
        })
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

/// Columns for deformed vertices and particles only where there are any.
fn lines(rows: &[BenchRow]) -> Vec<Vec<String>> {
    let deforms = rows.iter().any(|row| row.error.max_deform_px.is_some());
    let has_particles = rows.iter().any(|row| row.error.max_divergence_px.is_some());
    let columns: &[Column<BenchRow>] = &[
        ("SCENE", true, |row| row.scene.clone()),
        ("TRIANGLES", true, |row| row.triangles.to_string()),
        ("OPTION", true, |row| row.option.clone()),
        ("MS P50", true, |row| figure(row.ms_p50, 3)),
        ("MS P95", true, |row| figure(row.ms_p95, 3)),
        ("N", true, |row| row.samples.to_string()),
        ("WRONG", true, |row| count(row.error.wrong_triangles)),
        ("BY ROUNDING", true, |row| {
            count(row.error.explained_by_snap)
        }),
        ("HOLES", true, |row| count(row.error.holes)),
        ("DOUBLE", true, |row| count(row.error.double_hits)),
        ("MAX", true, |row| {
            count(row.error.max_color_delta.map(u64::from))
        }),
        ("RMS", true, |row| figure(row.error.rms_color_delta, 4)),
        ("DIVERGED PX", has_particles, |row| {
            figure(row.error.max_divergence_px, 5)
        }),
        ("DEFORM PX", deforms, |row| {
            figure(row.error.max_deform_px, 5)
        }),
        ("ADAPTER", true, |row| row.adapter.clone()),
    ];
    measured::lines(rows, columns)
}

fn count(count: Option<u64>) -> String {
    figure(count.map(|count| count as f64), 0)
}
