//! `bench --axes`: time and error of every combination of options on chosen accuracy axes.

use indicatif::ProgressBar;
use pollster::FutureExt as _;
use serde_json::Value;

use super::{
    args::{Bench, Common},
    backend::Backend,
    error::{CliError, Exit},
    measured::{judge, print_rows, subjects},
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
            judge: &|view, stack, capture| Some(judged(scene, view, stack, capture)),
        };
        let id = &preset_file.id;
        let measured = trade(gpu, preset, scene, id, &options, &reference, &mut progress);
        rows.extend(measured.block_on()?);
    }
    bar.finish_and_clear();
    let results = || {
        rows.iter()
            .map(serde_json::to_value)
            .collect::<Result<Vec<Value>, _>>()
            .map_err(CliError::usage)
    };
    let table = if args.each {
        prices(&rows)
    } else {
        lines(&rows)
    };
    print_rows(args, streams, &backend, &table, results)?;
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
fn judged(scene: &Scene, view: &View, stack: &Stack, capture: &Capture) -> Judged {
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
            "WRONG PPM".into(),
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

fn lines(rows: &[TradeRow]) -> Vec<Vec<String>> {
    let head = [
        "SCENE",
        "TRIANGLES",
        "OPTIONS",
        "MS P50",
        "MS P95",
        "N",
        "OUTLIERS",
        "WRONG PPM",
        "HOLES/MPX",
        "DOUBLE/MPX",
        "DEPTH PPM",
        "MAX",
        "RMS",
        "CHANGED",
        "MOVED PX",
        "CRACKS/MPX",
        "MIB",
        "GAIN",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    // Columns for particles only where there are any.
    let has_particles = rows.iter().any(|row| {
        row.error
            .is_some_and(|error| error.max_divergence_px.is_some())
    });
    let before_bytes = head.len() - 2;
    if has_particles {
        ["DIVERGED PX", "MEAN M"]
            .map(str::to_owned)
            .into_iter()
            .rev()
            .for_each(|cell| lines[0].insert(before_bytes, cell));
    }
    let not_measured = || "not measured".to_owned();
    let ms = |ms: Option<f64>| ms.map_or_else(not_measured, |ms| format!("{ms:.4}"));
    // Columns for shadows only where a light casts any.
    let has_light = rows.iter().any(|row| {
        row.error
            .is_some_and(|error| error.wrong_light_ppm.is_some())
    });
    let before_changed = head
        .iter()
        .position(|name| *name == "CHANGED")
        .expect("a column");
    if has_light {
        lines[0].splice(
            before_changed..before_changed,
            ["LIGHT PPM".to_owned(), "LIGHT RMS".to_owned()],
        );
    }
    // A column for CPU time only where the CPU selects dots.
    let has_cpu = rows.iter().any(|row| row.cpu_ms_p50.is_some());
    if has_cpu {
        lines[0].insert(5, "CPU MS".into());
    }
    lines.extend(rows.iter().map(|row| {
        let figure = |figure: &dyn Fn(&TradeError) -> String| {
            row.error.as_ref().map_or_else(not_measured, figure)
        };
        let mut line = vec![
            row.scene.clone(),
            row.triangles.to_string(),
            row.options.clone(),
            ms(row.ms_p50),
            ms(row.ms_p95),
            row.samples.to_string(),
            row.outliers.to_string(),
            figure(&|e| format!("{:.1}", e.wrong_ppm)),
            figure(&|e| format!("{:.1}", e.holes_per_mpx)),
            figure(&|e| format!("{:.1}", e.double_hits_per_mpx)),
            figure(&|e| format!("{:.1}", e.wrong_depth_ppm)),
            figure(&|e| e.max_color_delta.to_string()),
            figure(&|e| format!("{:.4}", e.rms_color_delta)),
            figure(&|e| e.changed_pixels.to_string()),
            figure(&|e| format!("{:.4}", e.moved_px)),
            figure(&|e| format!("{:.1}", e.cracks_per_mpx)),
            format!("{:.1}", row.bytes as f64 / f64::from(1 << 20)),
            if row.is_dominated { "no gain" } else { "-" }.into(),
        ];
        if has_particles {
            line.insert(
                before_bytes,
                figure(&|e| {
                    e.mean_divergence_m
                        .map_or_else(|| "-".into(), |m| format!("{m:.1e}"))
                }),
            );
            line.insert(
                before_bytes,
                figure(&|e| {
                    e.max_divergence_px
                        .map_or_else(|| "-".into(), |px| format!("{px:.4}"))
                }),
            );
        }
        if has_light {
            let light = |fraction: Option<f64>, digits: usize| {
                fraction.map_or_else(not_measured, |fraction| format!("{fraction:.digits$}"))
            };
            let cells = [
                figure(&|e| light(e.wrong_light_ppm, 1)),
                figure(&|e| light(e.rms_light, 4)),
            ];
            line.splice(before_changed..before_changed, cells);
        }
        if has_cpu {
            line.insert(
                5,
                row.cpu_ms_p50
                    .map_or_else(|| "-".into(), |ms| format!("{ms:.4}")),
            );
        }
        line
    }));
    lines
}
