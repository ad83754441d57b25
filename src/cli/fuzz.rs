//! `fuzz`: verifies random presets, and shrinks each that fails to the smallest one that still
//! does.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    time::{Duration, Instant},
};

use indicatif::ProgressBar;
use serde_json::{Value, json};

use super::{
    args::{Common, Fuzz},
    backend::Backend,
    error::{CliError, Exit},
    files::{self, Names},
    new_effect::named_effect,
    streams::Streams,
    verify,
};
use crate::{
    effects::{Effect, Stack},
    gpu::{RenderError, Renderer},
    preset::Preset,
    preset_file::{self, PresetFile},
    stress::{random, shrink},
};

/// Most presets that are verified to shrink one.
const MAX_SHRINK_CALLS: usize = 150;
/// A preset that takes longer is named, seconds.
const SLOW_S: f64 = 20.0;
/// How often a line says how far it is where no bar can be shown.
const TELL_EVERY: Duration = Duration::from_secs(10);

/// What verifying a preset leads to.
enum Outcome {
    Clean,
    /// Nothing that was pinned is exact, and the preset states no budget.
    ByDesign,
    /// It cannot be drawn, in one sentence for people.
    Refused(String),
    Failed(Vec<String>),
}

impl Outcome {
    const fn word(&self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::ByDesign => "by design",
            Self::Refused(_) => "refused",
            Self::Failed(_) => "failed",
        }
    }

    fn reasons(&self) -> &[String] {
        match self {
            Self::Clean | Self::ByDesign => &[],
            Self::Refused(reason) => std::slice::from_ref(reason),
            Self::Failed(reasons) => reasons,
        }
    }
}

pub fn run(common: &Common, args: &Fuzz, streams: &mut Streams) -> Result<Exit, CliError> {
    if !(common.set.is_empty() && common.unset.is_empty()) {
        return Err(CliError::usage(
            "fuzz takes no --set and no --unset: its presets are random",
        ));
    }
    let with = effects_with(common, args)?;
    let drawn = |seed| random::preset_with(seed, &with);
    let mut backend = Backend::open(common, streams)?;
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder).map_err(|e| {
            CliError::from(e).during(format!("{} cannot be created", folder.display()))
        })?;
    }
    let bar = streams.progress(args.count.into());
    let (mut results, mut counts) = (Vec::new(), [0u32; 4]);
    let begun = Instant::now();
    let mut told = begun;
    for seed in (0..args.count).map(|n| args.seed.wrapping_add(n)) {
        bar.set_message(format!("seed {seed}"));
        let begin = Instant::now();
        let outcome = match outcome(common, &drawn(seed), &mut backend) {
            Ok(outcome) => outcome,
            Err(error) => {
                note_kept(
                    &bar,
                    streams,
                    keep(args, &format!("lost-{seed}"), drawn(seed), common.force),
                );
                return Err(error.during(format!("seed {seed}")));
            }
        };
        let seconds = begin.elapsed().as_secs_f64();
        bar.inc(1);
        counts[match outcome {
            Outcome::Clean => 0,
            Outcome::ByDesign => 1,
            Outcome::Refused(_) => 2,
            Outcome::Failed(_) => 3,
        }] += 1;
        if seconds > SLOW_S {
            bar.suspend(|| streams.note(&format!("seed {seed} took {seconds:.0} s")));
            note_kept(
                &bar,
                streams,
                keep(args, &format!("slow-{seed}"), drawn(seed), common.force),
            );
        }
        let smallest = match &outcome {
            Outcome::Failed(reasons) => {
                bar.suspend(|| {
                    streams.note(&format!("seed {seed} failed: {}", reasons.join("; ")))
                });
                Some(shrunk(
                    common,
                    args,
                    (seed, drawn(seed)),
                    &mut backend,
                    streams,
                )?)
            }
            _ => None,
        };
        results.push(result(seed, &outcome, seconds, smallest));
        if bar.is_hidden() && told.elapsed() >= TELL_EVERY {
            told = Instant::now();
            streams.note(&format!(
                "{} of {} presets, {} failed; {:.0} s",
                results.len(),
                args.count,
                counts[3],
                begun.elapsed().as_secs_f64()
            ));
        }
    }
    bar.finish_and_clear();
    let [clean, by_design, refused, failed] = counts;
    if streams.json {
        streams.object("fuzz", backend.json(), results)?;
    } else {
        streams.text(&format!(
            "{} presets: {clean} clean, {by_design} with cheap options that err by design, {refused} refused in words, {failed} failed\n",
            args.count
        ))?;
    }
    Ok(Exit::failed_if(failed > 0))
}

/// The effects that every preset is to have.
fn effects_with(common: &Common, args: &Fuzz) -> Result<Vec<Arc<Effect>>, CliError> {
    let folders = common.folders();
    let mut stack = Stack::default();
    for name in &args.with {
        let effect = named_effect(&folders, "--with", name)?;
        if let Some(conflict) = stack.conflict_with(&effect) {
            return Err(CliError::usage(format!("--with: {conflict}")));
        }
        stack.enable(&effect);
    }
    let enabled = stack.0.into_iter();
    Ok(enabled.map(|enabled| enabled.effect).collect())
}

/// Shrinks the preset of a seed that failed, shows it and keeps it in the output folder.
fn shrunk(
    common: &Common,
    args: &Fuzz,
    (seed, preset): (u32, Preset),
    backend: &mut Backend,
    streams: &mut Streams,
) -> Result<String, CliError> {
    let mut lost = None;
    let smallest = shrink::shrink(preset, MAX_SHRINK_CALLS, |preset| {
        match outcome(common, preset, backend) {
            Ok(outcome) => matches!(outcome, Outcome::Failed(_)),
            Err(error) => {
                lost.get_or_insert(error);
                false
            }
        }
    });
    if let Some(error) = lost {
        return Err(error);
    }
    let reasons = outcome(common, &smallest, backend)?.reasons().join("; ");
    let toml = keep(args, &format!("random-{seed}"), smallest, common.force)?;
    if !streams.json {
        streams.text_now(&format!("# seed {seed}: {reasons}\n{toml}\n"))?;
    }
    Ok(toml)
}

/// A preset as TOML, which is stored in the output folder if there is one.
fn keep(args: &Fuzz, id: &str, preset: Preset, is_forced: bool) -> Result<String, CliError> {
    let toml = preset_file::to_toml(&PresetFile::new(id, preset));
    if let Some(folder) = &args.output {
        let (template, names) = (
            folder.join("{preset}.toml"),
            Names {
                preset: id.into(),
                ..Names::default()
            },
        );
        files::create(
            &template.to_string_lossy(),
            &names,
            is_forced,
            toml.as_bytes(),
        )?;
    }
    Ok(toml)
}

/// Says why a preset was not stored. What is wrong with the preset counts for more than where it is
/// stored, so the run goes on.
fn note_kept(bar: &ProgressBar, streams: &mut Streams, kept: Result<String, CliError>) {
    if let Err(error) = kept {
        bar.suspend(|| streams.note(&format!("the preset is not stored: {}", error.sentence())));
    }
}

/// Verifies a preset with every option that it allows.
///
/// # Errors
/// The device was lost.
fn outcome(common: &Common, preset: &Preset, backend: &mut Backend) -> Result<Outcome, CliError> {
    let verified = catch_unwind(AssertUnwindSafe(|| {
        let preset_file = PresetFile::new("random", preset.clone());
        let scene = preset_file::load_scene(preset, None)?;
        verify::check(
            common,
            &verify::Options {
                allows_any_band: true,
                ..Default::default()
            },
            &preset_file,
            &scene,
            backend,
        )
    }));
    let Ok(verified) = verified else {
        // The renderer may be in any state.
        if let Backend::Gpu(renderer, gpu) = backend {
            **renderer = Renderer::new(gpu.clone());
        }
        return Ok(Outcome::Failed(vec![
            "it panicked; the message stands above".into(),
        ]));
    };
    match verified {
        Ok(rows) => {
            let failures: Vec<String> = rows
                .iter()
                .flat_map(|row| row.failures.iter().map(|f| format!("{}: {f}", row.option)))
                .collect();
            Ok(match rows.iter().all(|row| row.without_budget.is_empty()) {
                _ if failures.is_empty() => Outcome::Clean,
                true => Outcome::Failed(failures),
                false => Outcome::ByDesign,
            })
        }
        Err(error) if error.exit == Exit::DeviceLost => Err(error),
        Err(error)
            if error
                .error
                .downcast_ref::<RenderError>()
                .is_some_and(RenderError::is_fault) =>
        {
            Ok(Outcome::Failed(vec![error.sentence()]))
        }
        Err(error) => Ok(Outcome::Refused(error.sentence())),
    }
}

fn result(seed: u32, outcome: &Outcome, seconds: f64, smallest: Option<String>) -> Value {
    json!({ "seed": seed, "outcome": outcome.word(), "reasons": outcome.reasons(), "seconds": seconds, "smallest": smallest })
}
