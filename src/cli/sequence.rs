//! `sequence`: draws an animated preset frame by frame in one process and on one device.

use std::{path::Path, sync::Arc};

use indicatif::ProgressBar;
use pollster::FutureExt as _;
use serde_json::{Value, json};

use super::{
    args::{Common, Sequence},
    backend::{Backend, scene_of, tell},
    error::{CliError, Exit},
    files::{self, Names},
    open::{named, open, open_as},
    render,
    streams::Streams,
};
use crate::{
    film::{
        Container, Film, FilmError, FrameJob, Observer, Outputs, Painter, Production, Schedule,
        Times, VideoTarget,
    },
    frame::Frame,
    preset::Preset,
    preset_file::{PresetFile, Provenance},
    scene::Scene,
};

impl Painter for Backend {
    type Error = CliError;

    fn provenance(&self) -> Provenance {
        self.provenance()
    }

    async fn paint(&mut self, preset: &Preset, scene: &Arc<Scene>) -> Result<Frame, CliError> {
        self.frame(preset, scene)
    }
}

/// Shows the progress of a film.
struct FilmBar(ProgressBar);

impl Observer for FilmBar {
    fn begins(&self, job: &FrameJob) {
        self.0.set_message(job.path.as_ref().map_or_else(
            || format!("frame {}", job.frame),
            |path| path.display().to_string(),
        ));
    }

    fn ended(&self, _: &FrameJob) {
        self.0.inc(1);
    }
}

impl From<FilmError> for CliError {
    fn from(error: FilmError) -> Self {
        match error {
            FilmError::Preset(error) => error.into(),
            FilmError::Exists { .. } => {
                Self::usage(format!("{error}; use --force to overwrite it"))
            }
            FilmError::NotOurs { .. } => Self::usage(format!("{error}; use --force to overwrite")),
            error => Self {
                exit: Exit::Usage,
                error: error.into(),
            },
        }
    }
}

pub fn run(common: &Common, args: &Sequence, streams: &mut Streams) -> Result<Exit, CliError> {
    let mut preset_file = open_with_flags(common, args)?;
    preset_file
        .remarks()
        .iter()
        .for_each(|remark| streams.note(remark));
    let container = args.video.as_deref().and_then(Container::of);
    if let Some(note) = container.and_then(|container| container.fps_note(args.fps)) {
        streams.note(&note);
    }
    let times = Times {
        from_s: args.from,
        to_s: args.to,
        fps: container.map_or(args.fps, |container| container.fps(args.fps)),
        frames: args.frames.unwrap_or_default(),
    };
    let schedule = Schedule::new(&times, &preset_file.preset.clock, "--")?;
    if args.count {
        return print_count(&schedule, streams);
    }
    check_template(args, &schedule)?;
    // What is missing for a video is said before anything is drawn.
    let video = args
        .video
        .as_deref()
        .map(|path| VideoTarget::new(path, preset_file.preset.output.size))
        .transpose()?;
    let scene = scene_of(common, &mut preset_file, streams)?;
    tell(&preset_file.preset, &scene, streams);
    let mut film = Film::new(preset_file, scene, schedule, args.turntable)?;
    if let Some(other) = &args.toward {
        film = film.toward(open(common, other)?)?;
    }
    if film.is_still() {
        streams.note(
            "info: nothing in this film moves, so every frame shows the same; --turntable turns it",
        );
    }
    let mut backend = Backend::open(common, streams)?;
    let outputs = Outputs {
        frames: frame_paths(args, &film, &backend)?,
        apng: args.apng.clone(),
        video,
    };
    let mut production = Production::begin(film, outputs, backend.provenance(), common.force)?;
    if !production.other_adapters.is_empty() {
        let adapters = production.other_adapters.join(", ");
        streams.note(&format!(
            "some of the kept frames were drawn by {adapters}; use --force to draw them again"
        ));
    }
    let bar = FilmBar(streams.progress(production.jobs.len() as u64));
    production.draw(&mut backend, &bar).block_on()?;
    bar.0.finish_and_clear();
    let (kept, schedule) = (production.kept(), &production.film().schedule);
    let drawn = production.jobs.len() - kept;
    let range = if production.jobs.len() < schedule.total as usize {
        format!(
            " of {}..{} of {}",
            schedule.frames.start, schedule.frames.end, schedule.total
        )
    } else {
        String::new()
    };
    streams.note(&format!(
        "{drawn} {} drawn, {kept} kept{range}",
        if drawn == 1 { "frame" } else { "frames" }
    ));
    print_results(args, &production, &backend, streams)?;
    Ok(Exit::Done)
}

/// How many frames there are, for a script that shares them out.
fn print_count(schedule: &Schedule, streams: &mut Streams) -> Result<Exit, CliError> {
    let count = schedule.frames.len();
    if streams.json {
        streams.object(
            "sequence",
            Value::Null,
            vec![json!({ "frames": count, "total": schedule.total, "fps": schedule.fps })],
        )?;
    } else {
        streams.text(&format!("{count}\n"))?;
    }
    Ok(Exit::Done)
}

/// Opens the preset with `--size` and `--tier`, which are short for `--set`.
fn open_with_flags(common: &Common, args: &Sequence) -> Result<PresetFile, CliError> {
    let tier = args.tier.as_deref();
    let mut preset_file = open_as(common, &args.input, args.size, None, tier)?;
    preset_file.preset.accuracy = preset_file.preset.accuracy.anti_aliased();
    let [width, height] = preset_file.preset.output.size;
    if width == 0 || height == 0 {
        return Err(CliError::usage(format!(
            "the size is {width}x{height}; PNG cannot hold a picture without pixels, so use --size with at least 1x1"
        )));
    }
    Ok(preset_file)
}

fn check_template(args: &Sequence, schedule: &Schedule) -> Result<(), CliError> {
    let Some(template) = &args.output else {
        return Ok(());
    };
    if template == "-" {
        return Err(CliError::usage(
            "-o -: a sequence has many files; use --apng FILE or --video FILE for a single file",
        ));
    }
    if files::has_number(template)? {
        return Err(CliError::usage(format!(
            "{template}: use {{frame}} instead of {{n}}, so that finished frames are found again"
        )));
    }
    if !files::has_frame(template)? && schedule.total > 1 {
        return Err(CliError::usage(format!(
            "{template}: put {{frame}} into the name, since there are {} frames",
            schedule.total
        )));
    }
    Ok(())
}

/// The files of the frames; empty without `-o`.
fn frame_paths(
    args: &Sequence,
    film: &Film,
    backend: &Backend,
) -> Result<Vec<std::path::PathBuf>, CliError> {
    let Some(template) = &args.output else {
        return Ok(Vec::new());
    };
    let names = render::names(film.preset_file(), backend);
    film.schedule
        .frames
        .clone()
        .map(|frame| {
            files::frame_path(
                template,
                &Names {
                    frame: Some(frame),
                    ..names.clone()
                },
            )
        })
        .collect()
}

fn print_results(
    args: &Sequence,
    production: &Production,
    backend: &Backend,
    streams: &mut Streams,
) -> Result<(), CliError> {
    let (jobs, film) = (&production.jobs, production.film());
    let (schedule, preset_file) = (&film.schedule, film.preset_file());
    if streams.json {
        let file =
            |path: Option<&Path>| path.map_or(Value::Null, |path| json!(path.to_string_lossy()));
        let row = |job: &FrameJob| {
            let row = json!({
                "frame": job.frame, "time_s": schedule.time_s(job.frame), "file": file(job.path.as_deref()),
                "kept": job.is_kept, "fingerprint": job.fingerprint,
            });
            named(preset_file, row)
        };
        let whole = |kind: &str, path: &Path| {
            named(
                preset_file,
                json!({ kind: file(Some(path)), "frames": jobs.len(), "fps": schedule.fps }),
            )
        };
        let apng = args.apng.iter().map(|path| whole("apng", path));
        let video = args.video.iter().map(|path| whole("video", path));
        let results = jobs.iter().map(row).chain(apng).chain(video).collect();
        streams.object("sequence", backend.json(), results)?;
        return Ok(());
    }
    let drawn = jobs
        .iter()
        .filter(|job| !job.is_kept)
        .filter_map(|job| job.path.as_deref());
    for path in drawn
        .chain(args.apng.as_deref())
        .chain(args.video.as_deref())
    {
        streams.text(&format!("{}\n", path.display()))?;
    }
    Ok(())
}
