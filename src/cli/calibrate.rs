//! `calibrate`: measures what units of work cost on an adapter and keeps it; with `--check` predicts and measures random presets.

use std::{path::PathBuf, sync::Arc};

use pollster::FutureExt as _;
use serde_json::{Map, Value, json};

use super::{
    args::{Calibrate, Common},
    backend::Backend,
    cost::{Cost, PictureCost, calibration_key, kept_calibration},
    error::{CliError, Exit},
    streams::{Streams, table},
};
use crate::{
    accuracy::AXES,
    gpu::{Gpu, RenderError, Renderer, calibration},
    oracle,
    plan::{
        MEASURED_OPTIONS, MEASURED_TRIANGLES,
        cost_model::{PassWork, Unit, UnitCosts},
    },
    preset_file::{self, Calibration, calibrations_folder},
    stress::random,
};

/// How far a predicted time may be from the measured one to count as right, as a fraction of the measured one.
const NEAR: f64 = 0.25;

pub fn run(common: &Common, args: &Calibrate, streams: &mut Streams) -> Result<Exit, CliError> {
    if !(common.set.is_empty() && common.unset.is_empty()) {
        return Err(CliError::usage("calibrate takes no --set and no --unset: its pictures are built in"));
    }
    let mut backend = Backend::open(common, streams)?;
    let adapter = backend.json();
    let Backend::Gpu(renderer, gpu) = &mut backend else {
        return Err(needs_adapter());
    };
    let kept = if common.force { None } else { kept_calibration(gpu, streams) };
    let is_new = kept.is_none();
    let found = match kept {
        Some(found) => {
            streams.note("the calibration that was kept for this adapter, driver and version; --force measures again");
            found
        }
        None => calibrated(gpu, streams)?,
    };
    let Some(count) = args.check else {
        print_calibration(&found, adapter, streams)?;
        return Ok(Exit::Done);
    };
    let checked = if is_new {
        // The device plans with the calibration that it was opened with.
        drop(backend);
        let Backend::Gpu(mut renderer, _) = Backend::open(common, streams)? else { return Err(needs_adapter()) };
        check(&mut renderer, &found.units, count, args.seed, streams)?
    } else {
        check(renderer, &found.units, count, args.seed, streams)?
    };
    print_check(&checked, adapter, streams)?;
    Ok(Exit::Done)
}

fn needs_adapter() -> CliError {
    CliError::usage("calibrate needs a GPU adapter; the oracle is not measured")
}

/// Measures and keeps what was found.
fn calibrated(gpu: &Arc<Gpu>, streams: &Streams) -> Result<Calibration, CliError> {
    let bar = streams.progress(0);
    let found = calibration::calibrate(gpu, oracle::moved_sizes, &|done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    })?;
    bar.finish_and_clear();
    streams.note(&format!(
        "{} pictures were measured in {:.2} s; compiling their kernels and making them ready took {:.1} s more",
        found.pictures, found.measuring_s, found.preparing_s
    ));
    let calibration = Calibration { units: found.units, measured: found.measured };
    match kept_in(gpu, &calibration) {
        Some(Ok(path)) => streams.note(&format!("kept in {}", path.display())),
        Some(Err(error)) => streams.note(&format!("the calibration is not kept: {error}")),
        None => streams.note("the calibration is not kept: there is no folder for the user's configuration"),
    }
    Ok(calibration)
}

fn kept_in(gpu: &Arc<Gpu>, calibration: &Calibration) -> Option<Result<PathBuf, preset_file::PresetError>> {
    Some(calibration_key(gpu).write(&calibrations_folder()?, calibration))
}

fn print_calibration(Calibration { units: costs, measured }: &Calibration, adapter: Value, streams: &mut Streams) -> Result<(), CliError> {
    let options = MEASURED_OPTIONS.iter().map(|&(axis, option)| {
        let fractions = MEASURED_TRIANGLES.map(|triangles| measured.options.fraction(axis, option, triangles.into()).unwrap_or(1.0));
        (format!("{}={}", AXES[axis].name, AXES[axis].words[option]), fractions)
    });
    if streams.json {
        let unit = |(unit, name, about): &(Unit, &str, &str)| json!({ "unit": name, "ms": costs.of(*unit), "what": about });
        let option = |(option, fractions): (String, [f64; 2])| json!({ "option": option, "of_the_defaults": fractions });
        let samples = json!({ "max_small_samples": measured.max_small_samples });
        streams.object("calibrate", adapter, Unit::ALL.iter().map(unit).chain(options.map(option)).chain([samples]).collect())?;
        return Ok(());
    }
    let mut rows = vec![["UNIT", "NANOSECONDS", "WHAT"].map(str::to_owned).to_vec()];
    rows.extend(Unit::ALL.iter().map(|(unit, name, about)| vec![(*name).into(), format!("{:.5}", costs.of(*unit) * 1e6), (*about).into()]));
    streams.text(&table(&rows))?;
    let [few, many] = MEASURED_TRIANGLES;
    let head = ["OPTION".into(), format!("AT {few} TRIANGLES"), format!("AT {many}")].to_vec();
    let rows = std::iter::once(head).chain(options.map(|(option, [few, many])| vec![option, format!("{few:.2}"), format!("{many:.2}")]));
    streams.text("\nTimes of frames with an option, as fractions of the time with the defaults:\n")?;
    streams.text(&table(&rows.collect::<Vec<_>>()))?;
    streams.text(&format!("\nOne invocation walks the samples of a triangle of up to {} samples.\n", measured.max_small_samples))?;
    Ok(())
}

/// A random preset, predicted and measured.
struct Checked {
    seed: u32,
    /// What it draws, in a few words.
    what: String,
    cost: PictureCost,
}

/// Predicts and measures the first `count` random presets from `seed` on that can be drawn and show pixels.
fn check(renderer: &mut Renderer, costs: &UnitCosts, count: u32, seed: u32, streams: &Streams) -> Result<Vec<Checked>, CliError> {
    let bar = streams.progress(count.into());
    let (mut checked, mut refused) = (Vec::new(), Vec::new());
    for seed in (0..).map(|n| seed.wrapping_add(n)) {
        bar.set_message(format!("seed {seed}"));
        let preset = random::preset(seed);
        let mut measured = || -> Result<_, CliError> {
            let scene = preset_file::load_scene(&preset, None)?;
            renderer.set_scene(&scene).block_on()?;
            let moments = preset.moments(&scene, preset.output.size);
            let (view, stack) = moments.last().ok_or_else(|| CliError::usage("it has no frame"))?;
            let cost = PictureCost::measured(renderer, view, stack, &preset.accuracy, Some(costs))?;
            Ok((scene, view.clone(), stack.clone(), cost))
        };
        match measured() {
            Ok((scene, view, stack, cost)) if cost.frame.ratio.is_some() => {
                let names: Vec<&str> = stack.0.iter().map(|enabled| enabled.effect.name).collect();
                let what = format!("{} triangles, {}x{}, {}", scene.triangle_count(), view.width, view.height, names.join(" "));
                checked.push(Checked { seed, what, cost });
                bar.inc(1);
            }
            Err(error) if error.error.downcast_ref::<RenderError>().is_some_and(|error| matches!(error, RenderError::Lost)) => {
                return Err(error);
            }
            Ok(_) => refused.push(format!("seed {seed} could not be timed")),
            Err(error) => refused.push(format!("seed {seed}: {}", error.error)),
        }
        if checked.len() >= count as usize || refused.len() > 10 * (count as usize + 1) {
            break;
        }
    }
    bar.finish_and_clear();
    refused.iter().for_each(|why| streams.note(&format!("left out: {why}")));
    Ok(checked)
}

/// A pass with its cost and with what the prediction counts in it.
fn pass_json(((label, cost), work): (&(String, Cost), &PassWork)) -> Value {
    let counts: Map<String, Value> = work.counts.iter().map(|(unit, count)| (unit.name().into(), json!(count))).collect();
    json!({ "name": label, "cost": cost, "counts": counts })
}

fn print_check(checked: &[Checked], adapter: Value, streams: &mut Streams) -> Result<(), CliError> {
    let is_near = |cost: &Cost| cost.ratio.is_some_and(|ratio| (ratio - 1.0).abs() <= NEAR);
    let near = checked.iter().filter(|one| is_near(&one.cost.frame)).count();
    if streams.json {
        let result = |one: &Checked| {
            json!({
                "seed": one.seed, "what": one.what, "cost": one.cost.frame, "is_near": is_near(&one.cost.frame),
                "passes": one.cost.passes.iter().zip(&one.cost.work.passes).map(pass_json).collect::<Vec<_>>(),
            })
        };
        streams.object("calibrate", adapter, checked.iter().map(result).collect())?;
        return Ok(());
    }
    let mut rows = vec![["SEED", "PREDICTED MS", "MEASURED MS", "RATIO", "PRESET"].map(str::to_owned).to_vec()];
    rows.extend(checked.iter().map(|one| {
        let [predicted, measured, ratio] = one.cost.frame.cells();
        vec![one.seed.to_string(), predicted, measured, ratio, one.what.clone()]
    }));
    streams.text(&table(&rows))?;
    let share = 100.0 * near as f64 / checked.len().max(1) as f64;
    streams.text(&format!("{near} of {} predictions within {:.0} % of the measured time: {share:.0} %\n", checked.len(), 100.0 * NEAR))?;
    Ok(())
}
