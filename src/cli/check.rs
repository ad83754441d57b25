//! `check`: validates looks, and with `--render` holds the adapter's pictures against the goldens.

use std::path::Path;

use serde_json::{Value, json};

use super::{
    args::{Check, Common},
    fault::{Exit, Fault},
    files::{self, Names},
    gallery_name, golden, open,
    painter::{Painter, scene_of},
    report,
    streams::Streams,
};
use crate::{
    measure::compare::{PictureDelta, pictures},
    preset_file::{self, PresetError, PresetFile},
};

/// What became of one preset.
pub struct Finding {
    pub preset_file: String,
    pub exit: Exit,
    /// One sentence each; empty when all is well.
    pub faults: Vec<String>,
    pub warnings: Vec<String>,
    pub position: Option<preset_file::Position>,
    pub drawn: Option<Drawn>,
}

/// A picture beside its golden.
pub struct Drawn {
    pub size: [u32; 2],
    pub expected: Vec<[u8; 4]>,
    pub actual: Vec<[u8; 4]>,
    pub delta: PictureDelta,
}

pub fn run(common: &Common, args: &Check, streams: &mut Streams) -> Result<Exit, Fault> {
    let files = if args.files.is_empty() {
        preset_file::gallery(common.presets_dir().as_deref()).iter().map(gallery_name).collect()
    } else {
        args.files.clone()
    };
    let mut painter = if args.render { Some(Painter::open(common, streams)?) } else { None };
    let bar = streams.progress(files.len() as u64);
    let mut findings = Vec::new();
    for file in &files {
        bar.set_message(file.clone());
        findings.push(check(common, args, file, painter.as_mut()));
        bar.inc(1);
    }
    bar.finish_and_clear();
    if let Some(report) = &args.report {
        let path = files::target(report, &Names { preset: "report".into(), ..Names::default() }, common.force)?;
        let adapter = painter.as_ref().map_or("none", Painter::name);
        files::write(&path, report::html(&findings, adapter)?.as_bytes())?;
    }
    let adapter = painter.as_ref().map_or(Value::Null, Painter::json);
    if streams.json {
        streams.object("check", adapter, findings.iter().map(json_finding).collect())?;
    } else {
        streams.text(&findings.iter().map(text).collect::<String>())?;
    }
    findings.iter().flat_map(|finding| &finding.warnings).for_each(|warning| streams.note(&format!("warning: {warning}")));
    Ok(findings.iter().fold(Exit::Done, |exit, finding| exit.and(finding.exit)))
}

fn check(common: &Common, args: &Check, file: &str, painter: Option<&mut Painter>) -> Finding {
    let id = Path::new(file).file_stem().map_or_else(|| file.to_owned(), |stem| stem.to_string_lossy().into_owned());
    let mut finding = Finding { preset_file: id, exit: Exit::Done, faults: Vec::new(), warnings: Vec::new(), position: None, drawn: None };
    let outcome = open(common, file).and_then(|preset_file| {
        finding.warnings.clone_from(&preset_file.warnings);
        let scene = scene_of(&preset_file)?;
        painter.map(|painter| drawn(args, &preset_file, &scene, painter)).transpose()
    });
    match outcome {
        Ok(Some((drawn, faults))) => {
            finding.exit = Exit::failed_if(!faults.is_empty());
            (finding.faults, finding.drawn) = (faults, drawn);
        }
        Ok(None) => {}
        Err(fault) => {
            finding.position = fault.error.downcast_ref::<PresetError>().and_then(PresetError::position);
            (finding.exit, finding.faults) = (fault.exit, vec![fault.sentence()]);
        }
    }
    finding
}

type Comparison = (Option<Drawn>, Vec<String>);

fn drawn(
    args: &Check,
    preset_file: &PresetFile,
    scene: &std::sync::Arc<crate::scene::Scene>,
    painter: &mut Painter,
) -> Result<Comparison, Fault> {
    let Some(test) = &preset_file.preset.test else { return Ok((None, Vec::new())) };
    let frame = painter.frame(&preset_file.preset, scene)?;
    let size = [frame.width, frame.height];
    let [png, _] = golden::paths(&args.snapshots, &preset_file.id);
    if !png.exists() {
        return Ok((None, vec![format!("{} is missing; rasterlab bless {} draws it", png.display(), preset_file.id)]));
    }
    let (expected, golden_size) = preset_file::png_pixels(&png)?;
    if golden_size != size {
        return Ok((None, vec![format!("{} has another size than the preset", png.display())]));
    }
    let delta = pictures(&expected, &frame.color, test.max_channel);
    let mut faults = Vec::new();
    // A wrong triangle id is a wrong pixel.
    let allowed = u64::from(test.max_pixels) + u64::from(test.max_wrong_triangles);
    if delta.pixels_over_tolerance > allowed {
        faults.push(format!(
            "{} pixels differ from the golden by more than {} of 255, the worst by {}; {allowed} are allowed",
            delta.pixels_over_tolerance, test.max_channel, delta.max_delta
        ));
    }
    Ok((Some(Drawn { size, expected, actual: frame.color, delta }), faults))
}

fn text(finding: &Finding) -> String {
    match (&finding.faults[..], &finding.drawn) {
        ([], Some(drawn)) => format!("ok    {}: largest difference {} of 255\n", finding.preset_file, drawn.delta.max_delta),
        ([], None) => format!("ok    {}\n", finding.preset_file),
        (faults, _) => faults.iter().map(|fault| format!("FAIL  {}: {fault}\n", finding.preset_file)).collect(),
    }
}

fn json_finding(finding: &Finding) -> Value {
    let position = finding.position.clone().unwrap_or_default();
    let error = |message: &String| {
        let file = if position.file.is_empty() { Value::Null } else { json!(position.file) };
        json!({ "code": finding.exit as u8, "message": message, "file": file, "line": position.line })
    };
    json!({
        "preset": finding.preset_file, "ok": finding.faults.is_empty(), "warnings": finding.warnings,
        "errors": finding.faults.iter().map(error).collect::<Vec<_>>(),
        "max_color_delta": finding.drawn.as_ref().map(|drawn| drawn.delta.max_delta),
        "pixels_over_tolerance": finding.drawn.as_ref().map(|drawn| drawn.delta.pixels_over_tolerance),
    })
}
