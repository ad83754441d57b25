//! `stress`: runs the extreme cases on the adapter, each with its expected outcome.

use serde_json::{Value, json};

use super::{
    args::{Common, Stress},
    backend::Backend,
    error::{CliError, Exit},
    streams::{Columns, Streams, table},
};
use crate::{
    gpu::Renderer,
    stress::{Case, Outcome, Report, chosen},
};

pub fn run(common: &Common, args: &Stress, streams: &mut Streams) -> Result<Exit, CliError> {
    let cases = chosen(args.filter.as_deref());
    if cases.is_empty() {
        let filter = args.filter.as_deref().unwrap_or_default();
        return Err(CliError::usage(format!(
            "no case has the number or name {filter:?}; rasterlab stress --list shows all"
        )));
    }
    if args.list {
        let mut rows = vec![
            ["CASE", "NAME", "EXPECTED", "WHAT"]
                .map(str::to_owned)
                .to_vec(),
        ];
        rows.extend(cases.iter().map(|case| {
            vec![
                case.number.to_string(),
                case.name.into(),
                case.expectation.to_string(),
                case.about.into(),
            ]
        }));
        streams.text(&table(&rows))?;
        return Ok(Exit::Done);
    }
    let mut backend = Backend::open(common, streams)?;
    let Backend::Gpu(renderer, gpu) = &mut backend else {
        return Err(CliError::usage(
            "stress needs a GPU adapter; the oracle is the reference",
        ));
    };
    let bar = streams.progress(cases.len() as u64);
    let columns = columns(&cases);
    if !streams.json {
        streams.text_now(&columns.line(&HEAD.map(str::to_owned)))?;
    }
    let mut reports = Vec::new();
    for case in &cases {
        let report = case.run(renderer, args.seed, &|what| {
            bar.set_message(format!("{}: {what}", case.name));
            true
        });
        bar.inc(1);
        if gpu.is_lost() {
            bar.finish_and_clear();
            streams.note(&line(&report));
            return Err(crate::gpu::RenderError::Lost.into());
        }
        if report.outcome.is_failure() {
            // A failure may leave queues and caches in a wrong state.
            **renderer = Renderer::new(gpu.clone());
            bar.suspend(|| streams.note(&line(&report)));
        }
        if !streams.json {
            // Some cases take minutes, so each row is printed at once.
            bar.suspend(|| streams.text_now(&columns.line(&row(&report))))?;
        }
        reports.push(report);
    }
    bar.finish_and_clear();
    let failed = reports
        .iter()
        .filter(|report| report.outcome.is_failure())
        .count();
    if streams.json {
        streams.object(
            "stress",
            backend.json(),
            reports.iter().map(result).collect(),
        )?;
    } else {
        remarks(&reports)
            .iter()
            .try_for_each(|remark| streams.text(&format!("{remark}\n")))?;
    }
    let seconds = reports.iter().map(|report| report.ms).sum::<f64>() / 1e3;
    let cases = if reports.len() == 1 { "case" } else { "cases" };
    streams.note(&format!(
        "{} {cases} in {seconds:.1} s, {failed} failed",
        reports.len()
    ));
    Ok(Exit::failed_if(failed > 0))
}

/// A failure in one line, with the command that repeats it.
fn line(report: &Report) -> String {
    let Report {
        number,
        name,
        outcome,
        seed,
        ..
    } = report;
    let seed = seed
        .map(|seed| format!(" (repeat with: rasterlab stress --filter {name} --seed {seed})"))
        .unwrap_or_default();
    format!(
        "case {number}, {name}: {}{seed}",
        outcome.why().unwrap_or(outcome.word())
    )
}

const HEAD: [&str; 7] = [
    "CASE",
    "NAME",
    "EXPECTED",
    "OUTCOME",
    "PICTURES",
    "TRIANGLES",
    "MS",
];

/// Columns that are wide enough for every row.
fn columns(cases: &[&Case]) -> Columns {
    let most = |digits: usize| "0".repeat(digits);
    let outcome = Outcome::Refused(String::new()).word().to_owned();
    let widest = |case: &&Case| {
        vec![
            case.number.to_string(),
            case.name.into(),
            case.expectation.to_string(),
            outcome.clone(),
            most(8),
            most(11),
            most(7),
        ]
    };
    Columns::of(
        &std::iter::once(HEAD.map(str::to_owned).to_vec())
            .chain(cases.iter().map(widest))
            .collect::<Vec<_>>(),
    )
}

fn row(report: &Report) -> Vec<String> {
    vec![
        report.number.to_string(),
        report.name.into(),
        report.expectation.to_string(),
        report.outcome.word().into(),
        report.counts.pictures.to_string(),
        report.counts.triangles.to_string(),
        format!("{:.0}", report.ms),
    ]
}

/// Details that are not in the table: failures first, then cases that were left out or refused, and
/// notes.
fn remarks(reports: &[Report]) -> Vec<String> {
    let (failed, others): (Vec<_>, Vec<_>) = reports
        .iter()
        .partition(|report| report.outcome.is_failure());
    let of = |report: &&Report| {
        let why = match &report.outcome {
            Outcome::Failed(_) => Some(format!("FAILED {}", line(report))),
            Outcome::Skipped(why) => {
                Some(format!("{} {}: skipped: {why}", report.number, report.name))
            }
            Outcome::Refused(why) => {
                Some(format!("{} {}: refused: {why}", report.number, report.name))
            }
            Outcome::Passed | Outcome::Stopped => None,
        };
        let notes = report
            .notes
            .iter()
            .map(|note| format!("{} {}: {note}", report.number, report.name));
        why.into_iter().chain(notes).collect::<Vec<_>>()
    };
    failed.iter().chain(&others).flat_map(of).collect()
}

fn result(report: &Report) -> Value {
    json!({
        "number": report.number, "name": report.name, "about": report.about, "expectation": report.expectation.to_string(),
        "outcome": report.outcome.word().to_lowercase(), "why": report.outcome.why(), "notes": report.notes, "seed": report.seed,
        "ms": report.ms, "pictures": report.counts.pictures, "pixels": report.counts.pixels, "triangles": report.counts.triangles,
    })
}
