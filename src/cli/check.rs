//! `check`: validates presets, and with `--render` compares the adapter's pictures with the
//! goldens.

use std::{path::Path, sync::Arc};

use serde_json::{Value, json};

use super::{
    args::{Check, Common},
    backend::{Backend, scene_with_warnings},
    error::{CliError, Exit},
    files::{self, Names},
    finding::{Drawn, Finding},
    open::{gallery_name, open},
    report,
    streams::Streams,
};
use crate::{
    gpu::RenderError,
    measure::compare::pictures,
    plan::{Caps, Planner},
    preset::Preset,
    preset_file::{self, PresetError, PresetFile, golden_folder, golden_paths},
    scene::{Scene, draw::draws, needs::Needs},
};

pub fn run(common: &Common, args: &Check, streams: &mut Streams) -> Result<Exit, CliError> {
    let files = if args.files.is_empty() {
        preset_file::gallery(&common.folders())
            .iter()
            .map(gallery_name)
            .collect()
    } else {
        args.files.clone()
    };
    let mut backend = if args.render {
        Some(Backend::open(common, streams)?)
    } else {
        None
    };
    let bar = streams.progress(files.len() as u64);
    let mut findings = Vec::new();
    for file in &files {
        bar.set_message(file.clone());
        findings.push(check(
            common,
            args.snapshots.as_deref(),
            file,
            backend.as_mut(),
        ));
        bar.inc(1);
    }
    bar.finish_and_clear();
    if let Some(report) = &args.report {
        let adapter = backend.as_ref().map_or("none", Backend::name);
        let names = Names {
            preset: "report".into(),
            ..Names::default()
        };
        files::create(
            report,
            &names,
            common.force,
            report::html(&findings, adapter)?.as_bytes(),
        )?;
    }
    let adapter = backend.as_ref().map_or(Value::Null, Backend::json);
    if streams.json {
        streams.object(
            "check",
            adapter,
            findings.iter().map(json_finding).collect(),
        )?;
    } else {
        streams.text(&findings.iter().map(text).collect::<String>())?;
    }
    findings
        .iter()
        .flat_map(|finding| &finding.warnings)
        .for_each(|warning| streams.note(&format!("warning: {warning}")));
    Ok(findings
        .iter()
        .fold(Exit::Done, |exit, finding| exit.and(finding.exit)))
}

/// Validates one preset, and compares what `backend` draws of it with its golden in `snapshots`, or
/// in the folder of its goldens.
pub fn check(
    common: &Common,
    snapshots: Option<&Path>,
    file: &str,
    backend: Option<&mut Backend>,
) -> Finding {
    let id = Path::new(file).file_stem().map_or_else(
        || file.to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    let mut finding = Finding {
        preset: id,
        exit: Exit::Done,
        problems: Vec::new(),
        warnings: Vec::new(),
        position: None,
        drawn: None,
    };
    let outcome = open(common, file).and_then(|mut preset_file| {
        finding.warnings.clone_from(&preset_file.warnings);
        let (scene, missing) = scene_with_warnings(common, &mut preset_file)?;
        finding.warnings.extend(missing);
        check_plan(&preset_file.preset, &scene)?;
        backend
            .map(|backend| compare_with_golden(snapshots, &preset_file, &scene, backend))
            .transpose()
    });
    match outcome {
        Ok(Some((drawn, problems))) => {
            finding.exit = Exit::failed_if(!problems.is_empty());
            (finding.problems, finding.drawn) = (problems, drawn);
        }
        Ok(None) => {}
        Err(error) => {
            finding.position = error
                .error
                .downcast_ref::<PresetError>()
                .and_then(PresetError::position);
            (finding.exit, finding.problems) = (error.exit, vec![error.sentence()]);
        }
    }
    finding
}

/// Is there a kernel for the preset, on the best of adapters?
fn check_plan(preset: &Preset, scene: &Scene) -> Result<(), CliError> {
    let view = preset.view(scene, preset.output.size);
    let needs = Arc::new(Needs::of(scene, &draws(scene, &view)?, &view));
    let caps = Caps::ALL;
    let planned = Planner::default().plan(
        &needs,
        &preset.stack_on(scene, preset.output.size),
        &caps,
        &caps.tuning(),
        &preset.accuracy,
    );
    planned
        .map(drop)
        .map_err(|error| RenderError::from(error).into())
}

type Comparison = (Option<Drawn>, Vec<String>);

fn compare_with_golden(
    snapshots: Option<&Path>,
    preset_file: &PresetFile,
    scene: &Arc<Scene>,
    backend: &mut Backend,
) -> Result<Comparison, CliError> {
    let Some(test) = &preset_file.preset.test else {
        return Ok((None, Vec::new()));
    };
    let frame = backend.frame(&preset_file.preset, scene)?;
    let size = [frame.width, frame.height];
    let folder = snapshots.map_or_else(|| golden_folder(preset_file), Path::to_owned);
    let [png, _] = golden_paths(&folder, &preset_file.id);
    if !png.exists() {
        return Ok((
            None,
            vec![format!(
                "{} is missing; draw it with rasterlab bless {}",
                png.display(),
                preset_file.id
            )],
        ));
    }
    let (expected, golden_size) = preset_file::png_pixels(&png)?;
    if golden_size != size {
        return Ok((
            None,
            vec![format!(
                "{} and the preset have different sizes",
                png.display()
            )],
        ));
    }
    let delta = pictures(&expected, &frame.color, test.max_channel);
    let mut problems = Vec::new();
    // A pixel with a wrong triangle has a wrong color.
    let allowed = u64::from(test.max_pixels) + u64::from(test.max_wrong_triangles);
    if delta.pixels_over_tolerance > allowed {
        problems.push(format!(
            "{} pixels differ from the golden by more than {} of 255, the worst by {}; {allowed} are allowed",
            delta.pixels_over_tolerance, test.max_channel, delta.max_delta
        ));
    }
    Ok((
        Some(Drawn {
            size,
            expected,
            actual: frame.color,
            delta,
        }),
        problems,
    ))
}

fn text(finding: &Finding) -> String {
    match (&finding.problems[..], &finding.drawn) {
        ([], Some(drawn)) => format!(
            "ok    {}: largest difference {} of 255\n",
            finding.preset, drawn.delta.max_delta
        ),
        ([], None) => format!("ok    {}\n", finding.preset),
        (problems, _) => problems
            .iter()
            .map(|error| format!("FAIL  {}: {error}\n", finding.preset))
            .collect(),
    }
}

fn json_finding(finding: &Finding) -> Value {
    let position = finding.position.clone().unwrap_or_default();
    let error = |message: &String| {
        let file = if position.file.is_empty() {
            Value::Null
        } else {
            json!(position.file)
        };
        json!({ "code": finding.exit as u8, "message": message, "file": file, "line": position.line })
    };
    json!({
        "preset": finding.preset, "ok": finding.problems.is_empty(), "warnings": finding.warnings,
        "errors": finding.problems.iter().map(error).collect::<Vec<_>>(),
        "max_color_delta": finding.drawn.as_ref().map(|drawn| drawn.delta.max_delta),
        "pixels_over_tolerance": finding.drawn.as_ref().map(|drawn| drawn.delta.pixels_over_tolerance),
    })
}
