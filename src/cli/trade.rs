//! `bench --axes`: time and error of every combination of options on chosen accuracy axes.

use indicatif::ProgressBar;
use pollster::FutureExt as _;

use super::{
    args::{Bench, Common},
    backend::Backend,
    error::{CliError, Exit},
    measured::{self, Column, figure, json_rows, judge, print_rows, subjects},
    streams::Streams,
};
use crate::{
    accuracy::{AXES, Axis},
    effects::Stack,
    gpu::Capture,
    oracle,
    params::did_you_mean,
    scene::{Scene, view::View},
    trade::{
        AS_PLANNED, Clock, Judged, Phase, Reference, Step, TradeError, TradeOptions, TradeRow,
        Watch, factors, trade,
    },
};

pub fn run(common: &Common, args: &Bench, streams: &mut Streams) -> Result<Exit, CliError> {
    let axes = axes(&args.axes)?;
    let options = TradeOptions {
        size: args.size,
        samples: args.samples as usize,
        clock: Clock::Adapter,
        axes,
        is_one_option_at_a_time: args.each,
    };
    let subjects = subjects(common, args, streams)?;
    let backend = Backend::open(common, streams)?;
    let Backend::Gpu(_, gpu) = &backend else {
        return Err(CliError::usage(
            "bench needs a GPU adapter; the oracle is not measured",
        ));
    };
    let bar = streams.progress(0);
    let mut rows = Vec::new();
    for (preset_file, scene) in &subjects {
        let preset = &preset_file.preset.drawn_on(scene, args.size[1]);
        bar.set_message("the oracle draws");
        let view = preset.view(scene, args.size);
        let factors = factors(preset, &options.axes);
        factors
            .iter()
            .try_for_each(|factor| oracle::can_judge(scene, &view, &preset.stack, *factor))?;
        let references = oracle::references(scene, &view, &preset.stack, &factors)?;
        let mut progress = Progress(&bar);
        let reference = Reference {
            references: &references,
            judge: &|view, stack, capture| Some(judge_capture(scene, view, stack, capture)),
        };
        let id = &preset_file.id;
        let measured = trade(gpu, preset, scene, id, &options, &reference, &mut progress);
        rows.extend(measured.block_on()?);
    }
    bar.finish_and_clear();
    let table = if args.each {
        prices(&rows)
    } else {
        lines(&rows)
    };
    print_rows(args, streams, &backend, &table, || json_rows(&rows))?;
    rows.iter()
        .filter(|row| row.error.is_none() || row.culled.is_some())
        .for_each(|row| {
            streams.note(&format!(
                "{} {}: {}",
                row.scene,
                row.options,
                row.note.as_deref().unwrap_or("not drawn")
            ));
        });
    Ok(Exit::Done)
}

/// Shows a measurement on the terminal.
struct Progress<'a>(&'a ProgressBar);

impl Watch for Progress<'_> {
    async fn goes_on(&mut self, step: &Step<'_>) -> bool {
        self.0.set_length(step.all as u64);
        self.0.set_position(step.done as u64);
        let doing = if step.phase == Phase::SetUp {
            "is compiled and judged"
        } else {
            "is timed"
        };
        self.0.set_message(format!("{} {doing}", step.what));
        true
    }
}

/// The oracle's verdict on a picture and on its shadows.
fn judge_capture(scene: &Scene, view: &View, stack: &Stack, capture: &Capture) -> Judged {
    let light = oracle::shadow_errors(
        scene,
        view,
        stack,
        &capture.frame.triangle_id,
        &capture.geometry,
    );
    Judged {
        verdict: judge(scene, view)(stack, capture),
        light: light.expect("a scene that was drawn can be judged"),
    }
}

/// The axes of these names.
fn axes(names: &[String]) -> Result<Vec<&'static Axis>, CliError> {
    let find = |name: &String| {
        Axis::find(name).ok_or_else(|| {
            let known: Vec<&str> = AXES.iter().map(|axis| axis.name).collect();
            CliError::usage(format!(
                "there is no axis {name:?}; the axes are {}{}",
                known.join(", "),
                did_you_mean(name, known.iter().copied())
            ))
        })
    };
    let mut axes: Vec<&'static Axis> = Vec::new();
    for axis in names.iter().map(find) {
        let axis = axis?;
        if !axes.iter().any(|known| known.name == axis.name) {
            axes.push(axis);
        }
    }
    Ok(axes)
}

/// A row per option: for every scene the time, its ratio to the planned one, and the error.
fn prices(rows: &[TradeRow]) -> Vec<Vec<String>> {
    let mut scenes: Vec<(&str, u64)> = rows
        .iter()
        .map(|row| (row.scene.as_str(), row.triangles))
        .collect();
    scenes.dedup();
    let mut options: Vec<&str> = Vec::new();
    rows.iter().for_each(|row| {
        if !options.contains(&row.options.as_str()) {
            options.push(&row.options);
        }
    });
    let row_of = |scene: &str, options: &str| {
        rows.iter()
            .find(|row| row.scene == scene && row.options == options)
    };
    let head = scenes.iter().flat_map(|(_, triangles)| {
        [
            format!("{triangles} TRIANGLES, MS"),
            "X".into(),
            "BY ROUNDING PPM".into(),
            "HOLES+DOUBLES".into(),
        ]
    });
    let mut table = vec![
        std::iter::once("OPTION".to_owned())
            .chain(head)
            .collect::<Vec<_>>(),
    ];
    for option in options {
        let cells = scenes.iter().flat_map(|(scene, _)| {
            let missing = || ["-".to_owned(), "-".into(), "-".into(), "-".into()];
            let (Some(row), Some(default)) = (row_of(scene, option), row_of(scene, AS_PLANNED))
            else {
                return missing();
            };
            let (Some(ms), Some(error)) = (row.ms_p50, row.error) else {
                return missing();
            };
            let ratio = default
                .ms_p50
                .map_or_else(|| "-".into(), |default| format!("{:.2}", ms / default));
            let samples = (error.holes_per_mpx + error.double_hits_per_mpx)
                * f64::from(row.size[0])
                * f64::from(row.size[1])
                / 1e6;
            [
                if ms < 10.0 {
                    format!("{ms:.4}")
                } else {
                    format!("{ms:.1}")
                },
                ratio,
                format!("{:.0}", error.wrong_ppm),
                format!("{samples:.0}"),
            ]
        });
        table.push(std::iter::once(option.to_owned()).chain(cells).collect());
    }
    table
}

/// Columns for the CPU's time, shadows and particles only where there are any.
fn lines(rows: &[TradeRow]) -> Vec<Vec<String>> {
    let has_cpu = rows.iter().any(|row| row.cpu_ms_p50.is_some());
    let has = |figure: fn(&TradeError) -> Option<f64>| {
        rows.iter()
            .any(|row| row.error.as_ref().and_then(figure).is_some())
    };
    let has_light = has(|e| e.wrong_light_ppm);
    let has_particles = has(|e| e.max_divergence_px);
    let columns: &[Column<TradeRow>] = &[
        ("SCENE", true, |row| row.scene.clone()),
        ("TRIANGLES", true, |row| row.triangles.to_string()),
        ("OPTIONS", true, |row| row.options.clone()),
        ("MS P50", true, |row| figure(row.ms_p50, 4)),
        ("MS P95", true, |row| figure(row.ms_p95, 4)),
        ("CPU MS", has_cpu, |row| {
            dash(row.cpu_ms_p50, |ms| format!("{ms:.4}"))
        }),
        ("N", true, |row| row.samples.to_string()),
        ("OUTLIERS", true, |row| row.outliers.to_string()),
        ("BY ROUNDING PPM", true, |row| {
            error(row, 1, |e| e.wrong_ppm)
        }),
        ("HOLES/MPX", true, |row| error(row, 1, |e| e.holes_per_mpx)),
        ("DOUBLE/MPX", true, |row| {
            error(row, 1, |e| e.double_hits_per_mpx)
        }),
        ("DEPTH PPM", true, |row| {
            error(row, 1, |e| e.wrong_depth_ppm)
        }),
        ("MAX", true, |row| {
            error(row, 0, |e| e.max_color_delta.into())
        }),
        ("RMS", true, |row| error(row, 4, |e| e.rms_color_delta)),
        ("LIGHT PPM", has_light, |row| {
            figure(row.error.and_then(|e| e.wrong_light_ppm), 1)
        }),
        ("LIGHT RMS", has_light, |row| {
            figure(row.error.and_then(|e| e.rms_light), 4)
        }),
        ("CHANGED", true, |row| {
            error(row, 0, |e| e.changed_pixels as f64)
        }),
        ("MOVED PX", true, |row| error(row, 4, |e| e.moved_px)),
        ("CRACKS/MPX", true, |row| {
            error(row, 1, |e| e.cracks_per_mpx)
        }),
        ("DIVERGED PX", has_particles, |row| {
            of_particles(row, |e| dash(e.max_divergence_px, |px| format!("{px:.4}")))
        }),
        ("MEAN M", has_particles, |row| {
            of_particles(row, |e| dash(e.mean_divergence_m, |m| format!("{m:.1e}")))
        }),
        ("MIB", true, |row| {
            format!("{:.1}", row.bytes as f64 / f64::from(1 << 20))
        }),
        ("GAIN", true, |row| {
            if row.is_dominated { "no gain" } else { "-" }.into()
        }),
    ];
    measured::lines(rows, columns)
}

fn dash(figure: Option<f64>, text: fn(f64) -> String) -> String {
    figure.map_or_else(|| "-".into(), text)
}

fn error(row: &TradeRow, digits: usize, of: fn(&TradeError) -> f64) -> String {
    figure(row.error.as_ref().map(of), digits)
}

fn of_particles(row: &TradeRow, text: fn(&TradeError) -> String) -> String {
    row.error.as_ref().map_or_else(|| figure(None, 0), text)
}
