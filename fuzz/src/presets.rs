//! Random presets against the oracle; each that fails is shrunk to the smallest that still does.

use std::{
    fs,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::Arc,
    time::Instant,
};

use pollster::FutureExt as _;
use rasterlab::{
    effects::{Effect, Stack},
    gpu::{RenderError, Renderer},
    oracle,
    preset::{Preset, Visibility},
    preset_file::{self, PresetFile},
};

use crate::stress::{options, random, shrink};

/// Most presets that are judged to shrink one.
const MAX_SHRINK_CALLS: usize = 150;
/// A preset that takes longer is named, seconds.
const SLOW_S: f64 = 20.0;

#[derive(clap::Args)]
pub struct Options {
    /// Seed of the first preset; each of the others has the next seed
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// Number of presets
    #[arg(long, default_value_t = 100)]
    pub count: u32,
    /// Effects that every preset has, separated by commas, instead of those that cannot be beside
    /// them
    #[arg(long, value_delimiter = ',')]
    pub with: Vec<String>,
    /// Shrink each preset that fails
    #[arg(long)]
    pub shrink: bool,
    /// Folder for the presets that failed, took long or lost the device
    #[arg(short, long)]
    pub output: Option<PathBuf>,
}

/// What judging a preset leads to.
#[derive(PartialEq)]
enum Outcome {
    Clean,
    /// Nothing that was pinned is exact, and the preset states no budget.
    ByDesign,
    Refused,
    Failed(String),
}

/// The number of presets that failed.
pub fn run(mut renderer: Renderer, args: &Options) -> Result<usize, String> {
    let with = effects_with(&args.with)?;
    let mut counts = [0; 4];
    for seed in (0..args.count).map(|n| args.seed.wrapping_add(n)) {
        let (preset, begin) = (random::preset_with(seed, &with), Instant::now());
        let judged = judge(&mut renderer, &preset);
        let seconds = begin.elapsed().as_secs_f64();
        if judged.is_err() {
            store(args, &format!("lost-{seed}"), &preset)?;
        }
        if seconds > SLOW_S {
            eprintln!("seed {seed} took {seconds:.0} s");
            store(args, &format!("slow-{seed}"), &preset)?;
        }
        let outcome = judged.map_err(|lost| format!("seed {seed}: {lost}"))?;
        let place = match &outcome {
            Outcome::Clean => 0,
            Outcome::ByDesign => 1,
            Outcome::Refused => 2,
            Outcome::Failed(_) => 3,
        };
        counts[place] += 1;
        if let Outcome::Failed(why) = outcome {
            eprintln!("seed {seed} failed: {why}");
            let smallest = if args.shrink {
                shrink::shrink(preset, MAX_SHRINK_CALLS, |preset| {
                    matches!(judge(&mut renderer, preset), Ok(Outcome::Failed(_)))
                })
            } else {
                preset
            };
            println!(
                "# seed {seed}\n{}",
                store(args, &format!("random-{seed}"), &smallest)?
            );
        }
    }
    let [clean, by_design, refused, failed] = counts;
    println!(
        "{} presets: {clean} clean, {by_design} with cheap options that err by design, {refused} refused in words, {failed} failed",
        args.count
    );
    Ok(failed)
}

fn effects_with(names: &[String]) -> Result<Vec<Arc<Effect>>, String> {
    let mut stack = Stack::default();
    for name in names {
        let effect = Effect::find(name).ok_or_else(|| format!("there is no effect {name}"))?;
        if let Some(conflict) = stack.conflict_with(effect) {
            return Err(conflict.to_string());
        }
        stack.enable(effect);
    }
    Ok(stack.0.into_iter().map(|enabled| enabled.effect).collect())
}

/// A preset as TOML, which is stored in the output folder if there is one.
fn store(args: &Options, id: &str, preset: &Preset) -> Result<String, String> {
    let toml = preset_file::to_toml(&PresetFile::new(id, preset.clone()));
    if let Some(folder) = &args.output {
        fs::create_dir_all(folder)
            .and_then(|()| fs::write(folder.join(format!("{id}.toml")), &toml))
            .map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    Ok(toml)
}

/// Draws a preset with every exact option that it allows, and judges each picture.
fn judge(renderer: &mut Renderer, preset: &Preset) -> Result<Outcome, String> {
    let gpu = renderer.gpu().clone();
    let judged = catch_unwind(AssertUnwindSafe(|| faults(renderer, preset)));
    match judged {
        Err(_) => {
            // The renderer may be in any state.
            *renderer = Renderer::new(gpu);
            Ok(Outcome::Failed(
                "it panicked; the message stands above".into(),
            ))
        }
        Ok(Err(Some(RenderError::Lost))) => Err("the device was lost".into()),
        Ok(Err(Some(error))) if error.is_fault() => Ok(Outcome::Failed(error.to_string())),
        Ok(Err(_)) => Ok(Outcome::Refused),
        Ok(Ok(faults)) if faults.is_empty() => Ok(Outcome::Clean),
        Ok(Ok(_)) if errs_by_design(preset) => Ok(Outcome::ByDesign),
        Ok(Ok(faults)) => Ok(Outcome::Failed(faults.join("; "))),
    }
}

fn errs_by_design(preset: &Preset) -> bool {
    preset.accuracy.may_err()
}

/// What is wrong with the pictures of a preset.
///
/// # Errors
/// It is refused; by the renderer with its error.
fn faults(renderer: &mut Renderer, preset: &Preset) -> Result<Vec<String>, Option<RenderError>> {
    let scene = preset_file::load_scene(preset, None).map_err(|_| None)?;
    let moments = preset.moments(&scene, preset.output.size);
    let (view, stack) = moments.last().ok_or(None)?;
    let scale = preset.accuracy.scale().factor();
    oracle::can_judge(&scene, view, stack, scale).map_err(|_| None)?;
    oracle::can_draw_sequence(&scene, &moments, scale).map_err(|_| None)?;
    let test = preset.test.clone().unwrap_or_default();
    let options = match preset.accuracy.pins.option::<Visibility>() {
        Some(pinned) => vec![pinned],
        None => options(&renderer.gpu().caps),
    };
    let mut faults = Vec::new();
    for option in options {
        let mut accuracy = preset.accuracy;
        accuracy.pins = accuracy.pins.with(option);
        renderer.set_scene(&scene).block_on()?;
        let capture = renderer.capture_last(&moments, &accuracy).block_on()?;
        let verdict = oracle::judge(&scene, view, stack, &capture.picture()).map_err(|_| None)?;
        let over = test.pixels_over_tolerance(&verdict, &capture.frame);
        let of_option = test.faults(&verdict.report, over, true);
        faults.extend(
            of_option
                .iter()
                .map(|fault| format!("{}: {fault}", option.name())),
        );
    }
    Ok(faults)
}
