//! `sequence`: draws an animated preset frame by frame in one process and on one device.
//!
//! Every file carries a fingerprint of its inputs. A complete picture with the right fingerprint is not drawn again, so an
//! interrupted sequence continues where it stopped, and several machines can each draw a range into a shared folder.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

use rayon::prelude::*;
use serde_json::{Value, json};

use super::{
    args::{Common, Sequence},
    backend::{Backend, scene_of},
    error::{CliError, Exit},
    files::{self, Names},
    golden::{Fnv, hex, preset_hash, scene_hash},
    open::open,
    render,
    streams::Streams,
};
use crate::{
    frame::Frame,
    preset::{Preset, SceneSource, animation::MAX_TIME_S},
    preset_file::{self, AnimatedPng, AnimationOptions, Existing, FrameStatus, PresetError, PresetFile},
    scene::Scene,
};

/// Largest number of frames: almost an hour at 30 per second.
const MAX_FRAMES: u32 = 100_000;

/// Largest number of frames per second; APNG counts milliseconds.
const MAX_FPS: f64 = 1000.0;

/// Bytes of drawn pictures that may wait to be written.
const BATCH_BYTES: u64 = 1 << 30;

/// The times of the frames.
#[derive(Clone, Debug, PartialEq)]
struct Schedule {
    from_s: f64,
    to_s: f64,
    fps: f64,
    /// Seconds of the clock from frame to frame.
    step_s: f64,
    /// Number of frames of the whole animation.
    total: u32,
    /// The frames to draw.
    frames: Range<u32>,
}

impl Schedule {
    fn of(args: &Sequence, preset: &Preset) -> Result<Self, CliError> {
        let [begin_s, end_s] = preset.clock.range_s;
        let (from_s, to_s, fps) = (args.from.unwrap_or(begin_s), args.to.unwrap_or(end_s), args.fps);
        for (name, time_s) in [("--from", from_s), ("--to", to_s)] {
            if !(-MAX_TIME_S..=MAX_TIME_S).contains(&time_s) {
                return Err(CliError::usage(format!("{name} {time_s} lies outside -1e9..=1e9")));
            }
        }
        if to_s <= from_s {
            return Err(CliError::usage(format!("--to {to_s} must come after --from {from_s}")));
        }
        if !(0.001..=MAX_FPS).contains(&fps) {
            return Err(CliError::usage(format!("--fps {fps} lies outside 0.001..=1000")));
        }
        let step_s = preset.clock.speed / fps;
        // Without the margin, rounding could add a last frame at the end, which equals the first of the next round.
        let count = ((to_s - from_s) / step_s - 1e-6).ceil().max(1.0);
        if count > f64::from(MAX_FRAMES) {
            return Err(CliError::usage(format!(
                "{count} frames from {from_s} to {to_s} s are too many; at most {MAX_FRAMES} are allowed"
            )));
        }
        let total = count as u32;
        let [first, end] = args.frames.unwrap_or_default();
        let frames = first.unwrap_or(0)..end.unwrap_or(total);
        if frames.is_empty() || frames.end > total {
            let Range { start, end } = frames;
            return Err(CliError::usage(format!(
                "--frames {start}..{end} lies outside 0..{total}, the frames from {from_s} to {to_s} s at {fps} a second"
            )));
        }
        Ok(Self { from_s, to_s, fps, step_s, total, frames })
    }

    /// Computed from the frame number, so that errors do not add up and every machine gets the same time.
    fn time_s(&self, frame: u32) -> f64 {
        self.from_s + f64::from(frame) * self.step_s
    }
}

/// A frame to draw or to keep.
struct FrameJob {
    frame: u32,
    fingerprint: String,
    path: Option<PathBuf>,
    /// Its file is finished and stays.
    is_kept: bool,
    /// What happens to a file that is there when the frame is written.
    existing: Existing,
}

pub fn run(common: &Common, args: &Sequence, streams: &mut Streams) -> Result<Exit, CliError> {
    let preset_file = open_with_flags(common, args)?;
    preset_file.remarks().iter().for_each(|remark| streams.note(remark));
    let schedule = Schedule::of(args, &preset_file.preset)?;
    check_template(args, &schedule)?;
    let scene = scene_of(common, &preset_file, streams)?;
    scene.notes.iter().for_each(|note| streams.note(note));
    at(&preset_file, &schedule, schedule.frames.end - 1).check_savable()?;
    let mut backend = Backend::open(common, streams)?;
    let mut jobs = jobs(args, &preset_file, &scene, &schedule, &backend)?;
    find_finished(common, &mut jobs, preset_file.preset.output.size, &backend, streams)?;
    let mut animation = animation(common, args, &preset_file, &schedule, &jobs, &backend)?;
    if animation.is_none() {
        // The animation is finished already, so frames without a file are not needed.
        jobs.iter_mut().filter(|job| job.path.is_none()).for_each(|job| job.is_kept = true);
    }
    let kept = jobs.iter().filter(|job| job.is_kept).count();
    let of = |job: &FrameJob| at(&preset_file, &schedule, job.frame);
    draw(&jobs, &of, preset_file.preset.output.size, &scene, &mut backend, &mut animation, streams)?;
    if let Some(animation) = animation {
        animation.finish()?;
    }
    let drawn = jobs.len() - kept;
    let range = if jobs.len() < schedule.total as usize {
        format!(" of {}..{} of {}", schedule.frames.start, schedule.frames.end, schedule.total)
    } else {
        String::new()
    };
    streams.note(&format!("{drawn} {} drawn, {kept} kept{range}", if drawn == 1 { "frame" } else { "frames" }));
    print_results(args, &jobs, &schedule, &backend, streams)?;
    Ok(Exit::Done)
}

/// Opens the preset with `--size` and `--tier`, which are short for `--set`.
fn open_with_flags(common: &Common, args: &Sequence) -> Result<PresetFile, CliError> {
    let mut preset_file = open(common, &args.input)?;
    if let Some(size) = args.size {
        preset_file.preset.output.size = size;
    }
    if let Some(tier) = &args.tier {
        preset_file::set(&mut preset_file, "accuracy.tier", tier)?;
    }
    let [width, height] = preset_file.preset.output.size;
    if width == 0 || height == 0 {
        return Err(CliError::usage(format!(
            "the size is {width}x{height}; PNG cannot hold a picture without pixels, so use --size with at least 1x1"
        )));
    }
    Ok(preset_file)
}

fn check_template(args: &Sequence, schedule: &Schedule) -> Result<(), CliError> {
    let Some(template) = &args.output else { return Ok(()) };
    if template == "-" {
        return Err(CliError::usage("-o -: a sequence has many files; use --apng FILE for a single file"));
    }
    if files::has_number(template)? {
        return Err(CliError::usage(format!("{template}: use {{frame}} instead of {{n}}, so that finished frames are found again")));
    }
    if !files::has_frame(template)? && schedule.total > 1 {
        return Err(CliError::usage(format!("{template}: put {{frame}} into the name, since there are {} frames", schedule.total)));
    }
    Ok(())
}

fn jobs(
    args: &Sequence,
    preset_file: &PresetFile,
    scene: &Scene,
    schedule: &Schedule,
    backend: &Backend,
) -> Result<Vec<FrameJob>, CliError> {
    let (scene, names) = (scene_hash(scene), render::names(preset_file, backend));
    let job = |frame| {
        let names = Names { frame: Some(frame), ..names.clone() };
        let path = args.output.as_ref().map(|template| files::frame_path(template, &names)).transpose()?;
        Ok(FrameJob {
            frame,
            fingerprint: fingerprint(&at(preset_file, schedule, frame).preset, scene),
            path,
            is_kept: false,
            existing: Existing::Keep,
        })
    };
    schedule.frames.clone().into_par_iter().map(job).collect()
}

/// The preset at the time of a frame.
fn at(preset_file: &PresetFile, schedule: &Schedule, frame: u32) -> PresetFile {
    let mut preset_file = preset_file.clone();
    preset_file.preset.clock.time_s = schedule.time_s(frame);
    preset_file
}

/// Hash of the preset at its time, the scene's bytes and the version of this program; not of the adapter.
fn fingerprint(preset: &Preset, scene: Fnv) -> String {
    // The path of the scene differs between machines; the hash of its bytes replaces it.
    let anywhere = Preset { scene: SceneSource::Builtin(String::new()), ..preset.clone() };
    let hashes = [preset_hash(&anywhere).0, scene.0];
    let hash = hashes.iter().fold(Fnv::new().bytes(env!("CARGO_PKG_VERSION").as_bytes()), |hash, part| hash.bytes(&part.to_le_bytes()));
    hex(hash)
}

/// Finds the finished frames. Any other file is overwritten only with `--force`.
fn find_finished(common: &Common, jobs: &mut [FrameJob], size: [u32; 2], backend: &Backend, streams: &Streams) -> Result<(), CliError> {
    if let Some(folder) = jobs.first().and_then(|job| job.path.as_deref()).and_then(Path::parent).filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|e| CliError::from(e).during(format!("{} cannot be created", folder.display())))?;
    }
    let found: Vec<FrameStatus> = jobs
        .par_iter()
        .map(|job| job.path.as_ref().map_or(Ok(FrameStatus::Absent), |path| preset_file::frame_status(path, size, &job.fingerprint)))
        .collect::<Result<_, PresetError>>()?;
    let others: Vec<&Path> =
        jobs.iter().zip(&found).filter(|(_, found)| **found == FrameStatus::Other).filter_map(|(job, _)| job.path.as_deref()).collect();
    if let ([first, rest @ ..], false) = (&others[..], common.force) {
        let more = if rest.is_empty() { String::new() } else { format!(", as do {} more files", rest.len()) };
        let first = first.display();
        return Err(CliError::usage(format!("{first} exists and is no frame of this preset{more}; use --force to overwrite")));
    }
    let mut other_adapters: Vec<&str> = Vec::new();
    for (job, found) in jobs.iter_mut().zip(&found) {
        job.existing = if *found == FrameStatus::Absent { Existing::Keep } else { Existing::Replace };
        let FrameStatus::Finished { adapter } = found else { continue };
        let is_ours = adapter == backend.name();
        job.is_kept = is_ours || !common.force;
        if !is_ours && job.is_kept && !other_adapters.contains(&adapter.as_str()) {
            other_adapters.push(adapter);
        }
    }
    if !other_adapters.is_empty() {
        streams.note(&format!("some of the kept frames were drawn by {}; use --force to draw them again", other_adapters.join(", ")));
    }
    Ok(())
}

/// Begins the animated PNG, if there is to be one and it is not finished already.
fn animation(
    common: &Common,
    args: &Sequence,
    preset_file: &PresetFile,
    schedule: &Schedule,
    jobs: &[FrameJob],
    backend: &Backend,
) -> Result<Option<AnimatedPng>, CliError> {
    let Some(path) = &args.apng else { return Ok(None) };
    let clock = preset_file.preset.clock;
    let delay_s = delay(schedule.fps);
    let options =
        AnimationOptions { size: preset_file.preset.output.size, frames: jobs.len() as u32, delay_s, is_looping: clock.is_looping };
    let all = jobs.iter().fold(Fnv::new(), |hash, job| hash.bytes(job.fingerprint.as_bytes()));
    let fingerprint = hex(all.words(&[delay_s[0].into(), delay_s[1].into(), clock.is_looping.into()]));
    let found = preset_file::frame_status(path, options.size, &fingerprint)?;
    match &found {
        FrameStatus::Finished { adapter } if adapter == backend.name() => return Ok(None),
        FrameStatus::Finished { .. } | FrameStatus::Other if !common.force => {
            return Err(CliError::usage(format!("{} exists; use --force to overwrite it", path.display())));
        }
        _ => {}
    }
    let existing = if found == FrameStatus::Absent { Existing::Keep } else { Existing::Replace };
    let saved = preset_file.for_picture(path);
    Ok(Some(AnimatedPng::begin(path, &options, &saved, &backend.provenance(), &fingerprint, existing)?))
}

/// The time of one frame in seconds as the closest fraction that APNG can hold.
fn delay(fps: f64) -> [u16; 2] {
    let mut best = ([1, 1], f64::INFINITY);
    for numerator in 1..=1001u16 {
        let denominator = (f64::from(numerator) * fps).round();
        if !(1.0..=65_535.0).contains(&denominator) {
            continue;
        }
        let error = (f64::from(numerator) / denominator * fps - 1.0).abs();
        if error < best.1 - 1e-12 {
            best = ([numerator, denominator as u16], error);
        }
    }
    best.0
}

/// Draws the frames that are not kept, in batches: the device draws one at a time, and a batch is compressed in parallel.
fn draw(
    jobs: &[FrameJob],
    preset_of: &(impl Fn(&FrameJob) -> PresetFile + Sync),
    size: [u32; 2],
    scene: &Arc<Scene>,
    backend: &mut Backend,
    animation: &mut Option<AnimatedPng>,
    streams: &Streams,
) -> Result<(), CliError> {
    let bar = streams.progress(jobs.len() as u64);
    let provenance = backend.provenance();
    let frame_bytes = 4 * u64::from(size[0]) * u64::from(size[1]);
    let batch = (BATCH_BYTES / frame_bytes.max(1)).clamp(1, rayon::current_num_threads() as u64) as usize;
    for jobs in jobs.chunks(batch) {
        let mut drawn: Vec<Option<Frame>> = Vec::new();
        for job in jobs {
            bar.set_message(job.path.as_ref().map_or_else(|| format!("frame {}", job.frame), |path| path.display().to_string()));
            drawn.push(if !job.is_kept { Some(backend.frame(&preset_of(job).preset, scene)?) } else { None });
            bar.inc(1);
        }
        jobs.par_iter().zip(&drawn).try_for_each(|(job, frame)| match (&job.path, frame) {
            (Some(path), Some(frame)) => {
                let png = preset_file::png_of_frame(frame, &preset_of(job).for_picture(path), &provenance, &job.fingerprint)?;
                files::write(path, &png, job.existing)
            }
            _ => Ok(()),
        })?;
        let Some(animation) = animation.as_mut() else { continue };
        for (job, frame) in jobs.iter().zip(drawn) {
            match (frame, &job.path) {
                (Some(frame), _) => animation.push(&frame.color)?,
                (None, Some(path)) => animation.push(&preset_file::png_pixels(path)?.0)?,
                (None, None) => unreachable!("a frame without a file is drawn for the animation"),
            }
        }
    }
    bar.finish_and_clear();
    Ok(())
}

fn print_results(
    args: &Sequence,
    jobs: &[FrameJob],
    schedule: &Schedule,
    backend: &Backend,
    streams: &mut Streams,
) -> Result<(), CliError> {
    if streams.json {
        let file = |path: Option<&Path>| path.map_or(Value::Null, |path| json!(path.to_string_lossy()));
        let row = |job: &FrameJob| {
            json!({
                "frame": job.frame, "time_s": schedule.time_s(job.frame), "file": file(job.path.as_deref()),
                "kept": job.is_kept, "fingerprint": job.fingerprint,
            })
        };
        let apng = args.apng.iter().map(|path| json!({ "apng": file(Some(path)), "frames": jobs.len(), "fps": schedule.fps }));
        let results = jobs.iter().map(row).chain(apng).collect();
        streams.object("sequence", backend.json(), results)?;
        return Ok(());
    }
    let drawn = jobs.iter().filter(|job| !job.is_kept).filter_map(|job| job.path.as_deref());
    for path in drawn.chain(args.apng.as_deref()) {
        streams.text(&format!("{}\n", path.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::Clock;

    fn args(from: Option<f64>, to: Option<f64>, fps: f64, frames: Option<[Option<u32>; 2]>) -> Sequence {
        Sequence { input: String::new(), output: None, apng: None, from, to, fps, frames, size: None, tier: None }
    }

    #[test]
    fn a_loop_does_not_draw_its_first_moment_twice() {
        let preset = Preset::default();
        for fps in [24.0, 25.0, 29.97, 30.0, 60.0, 144.0, 1.0, 0.3] {
            let schedule = Schedule::of(&args(Some(-1.0), Some(3.1), fps, None), &preset).unwrap();
            let last = schedule.time_s(schedule.total - 1);
            assert!(last < 3.1 && last + 1.0 / fps > 3.1 - 1e-6, "{fps}: {last}");
        }
        assert_eq!(Schedule::of(&args(None, None, 30.0, None), &preset).unwrap().total, 120);
    }

    #[test]
    fn the_speed_of_the_clock_is_the_speed_of_the_film() {
        let clock = Clock { range_s: [0.0, 4.0], speed: 2.0, ..Clock::default() };
        let schedule = Schedule::of(&args(None, None, 30.0, Some([Some(30), None])), &Preset { clock, ..Preset::default() }).unwrap();
        assert_eq!((schedule.total, schedule.frames.clone(), schedule.time_s(30)), (60, 30..60, 2.0));
    }

    #[test]
    fn a_rate_is_kept_as_a_fraction() {
        assert_eq!([delay(30.0), delay(29.97), delay(0.5), delay(1000.0)], [[1, 30], [100, 2997], [2, 1], [1, 1000]]);
        assert!((f64::from(delay(23.976)[0]) / f64::from(delay(23.976)[1]) * 23.976 - 1.0).abs() < 1e-9);
        assert!(delay(0.001)[1] == 1);
    }
}
