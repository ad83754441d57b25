//! `stress`: runs the extreme cases on the adapter, each with what must hold.

use serde_json::{Value, json};

use super::{
    args::{Common, Stress},
    backend::Backend,
    error::{CliError, Exit},
    streams::{Columns, Streams, table},
};
use crate::{
    extremes::{Cases, Outcome, Report, names},
    gpu::Renderer,
};

pub fn run(common: &Common, args: &Stress, streams: &mut Streams) -> Result<Exit, CliError> {
    let names = names(args.filter.as_deref());
    if names.is_empty() {
        let filter = args.filter.as_deref().unwrap_or_default();
        return Err(CliError::usage(format!(
            "no case has a name with {filter:?}; rasterlab stress --list shows all"
        )));
    }
    let cases =
        Cases::unpack().map_err(|e| CliError::from(e).during("the cases cannot be written"))?;
    if args.list {
        let head = ["NAME", "WHAT"].map(str::to_owned).to_vec();
        let rows = names
            .iter()
            .map(|name| vec![(*name).to_owned(), cases.about(name)]);
        streams.text(&table(
            &std::iter::once(head).chain(rows).collect::<Vec<_>>(),
        ))?;
        return Ok(Exit::Done);
    }
    let mut backend = Backend::open(common, streams)?;
    let Backend::Gpu(renderer, gpu) = &mut backend else {
        return Err(CliError::usage(
            "stress needs a GPU adapter; the oracle is the reference",
        ));
    };
    let bar = streams.progress(names.len() as u64);
    let columns = columns(&names);
    if !streams.json {
        streams.text_now(&columns.line(&HEAD.map(str::to_owned)))?;
    }
    let mut reports = Vec::new();
    for name in names {
        let report = cases.run(name, renderer, &|what| {
            bar.set_message(format!("{name}: {what}"));
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
            // Some cases take long, so each row is printed at once.
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
        let results = reports.iter().map(result).collect();
        streams.object("stress", backend.json(), results)?;
    } else {
        let refused = reports
            .iter()
            .filter(|report| matches!(report.outcome, Outcome::Refused(_)));
        for report in refused {
            streams.text(&format!("{}\n", line(report)))?;
        }
    }
    let seconds = reports.iter().map(|report| report.ms).sum::<f64>() / 1e3;
    let cases = if reports.len() == 1 { "case" } else { "cases" };
    streams.note(&format!(
        "{} {cases} in {seconds:.1} s, {failed} failed",
        reports.len()
    ));
    Ok(Exit::failed_if(failed > 0))
}

/// What came of a case, in one line.
fn line(report: &Report) -> String {
    let Report { name, outcome, .. } = report;
    format!(
        "case {name}: {}: {}",
        outcome.word(),
        outcome.why().unwrap_or_default()
    )
}

const HEAD: [&str; 5] = ["NAME", "OUTCOME", "PICTURES", "TRIANGLES", "MS"];

/// Columns that are wide enough for every row.
fn columns(names: &[&str]) -> Columns {
    let outcome = Outcome::Refused(String::new()).word();
    let widest = |name| [name, outcome, "00000000", "00000000000", "0000000"];
    let rows = std::iter::once(HEAD).chain(names.iter().copied().map(widest));
    Columns::of(
        &rows
            .map(|row| row.map(str::to_owned).to_vec())
            .collect::<Vec<_>>(),
    )
}

fn row(report: &Report) -> Vec<String> {
    vec![
        report.name.into(),
        report.outcome.word().into(),
        report.pictures.to_string(),
        report.triangles.to_string(),
        format!("{:.0}", report.ms),
    ]
}

fn result(report: &Report) -> Value {
    json!({
        "name": report.name, "about": report.about, "outcome": report.outcome.word().to_lowercase(), "why": report.outcome.why(),
        "ms": report.ms, "pictures": report.pictures, "triangles": report.triangles,
    })
}
