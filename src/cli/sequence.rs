//! `sequence`: a moving preset, frame by frame, from one process and one device.
//!
//! Every frame carries a mark of all that decided it. A whole picture with the right mark is finished and is not drawn
//! again, so an interrupted sequence goes on where it stopped, and machines that share a folder can each take a range.

use std::{
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

use rayon::prelude::*;
use serde_json::{Value, json};

use super::{
    args::{Common, Sequence},
    fault::{Exit, Fault},
    files::{self, Names},
    golden::{Fnv, hex, preset_hash, scene_hash},
    open,
    painter::{Painter, scene_of},
    render,
    streams::Streams,
};
use crate::{
    frame::Frame,
    preset::{Preset, SceneSource, animation::MAX_TIME_S},
    preset_file::{self, AnimatedPng, AnimationOptions, FrameStatus, PresetError, PresetFile},
    scene::Scene,
};

/// Most frames of a film: almost an hour at 30 a second.
const MAX_FRAMES: u32 = 100_000;

/// Most frames in a second; APNG counts thousandths.
const MAX_FPS: f64 = 1000.0;

/// Bytes of finished pictures that may wait for the disk.
const BATCH_BYTES: u64 = 1 << 30;

/// Which moments are drawn.
#[derive(Clone, Debug, PartialEq)]
struct Schedule {
    from_s: f64,
    to_s: f64,
    fps: f64,
    /// Seconds of the preset from frame to frame.
    step_s: f64,
    /// Frames of the whole film.
    total: u32,
    /// Those to be drawn here.
    frames: Range<u32>,
}

impl Schedule {
    fn of(args: &Sequence, preset: &Preset) -> Result<Self, Fault> {
        let [begin_s, end_s] = preset.clock.range_s;
        let (from_s, to_s, fps) = (args.from.unwrap_or(begin_s), args.to.unwrap_or(end_s), args.fps);
        for (name, time_s) in [("--from", from_s), ("--to", to_s)] {
            if !(-MAX_TIME_S..=MAX_TIME_S).contains(&time_s) {
                return Err(Fault::usage(format!("{name} {time_s} lies outside -1e9..=1e9")));
            }
        }
        if to_s <= from_s {
            return Err(Fault::usage(format!("--to {to_s} must come after --from {from_s}")));
        }
        if !(0.001..=MAX_FPS).contains(&fps) {
            return Err(Fault::usage(format!("--fps {fps} lies outside 0.001..=1000")));
        }
        let step_s = preset.clock.speed / fps;
        // A last frame that rounding alone puts before the end would be drawn twice in a loop.
        let count = ((to_s - from_s) / step_s - 1e-6).ceil().max(1.0);
        if count > f64::from(MAX_FRAMES) {
            return Err(Fault::usage(format!("{count} frames from {from_s} to {to_s} s are too many; at most {MAX_FRAMES} are drawn")));
        }
        let total = count as u32;
        let [first, end] = args.frames.unwrap_or_default();
        let frames = first.unwrap_or(0)..end.unwrap_or(total);
        if frames.is_empty() || frames.end > total {
            let Range { start, end } = frames;
            return Err(Fault::usage(format!(
                "--frames {start}..{end} lies outside 0..{total}, the frames from {from_s} to {to_s} s at {fps} a second"
            )));
        }
        Ok(Self { from_s, to_s, fps, step_s, total, frames })
    }

    /// From the frame's number alone, so that no error adds up and every machine finds the same moment.
    fn time_s(&self, frame: u32) -> f64 {
        self.from_s + f64::from(frame) * self.step_s
    }
}

/// A frame to be drawn, or kept.
struct Shot {
    frame: u32,
    mark: String,
    path: Option<PathBuf>,
    /// A finished picture is there.
    kept: bool,
}

pub fn run(common: &Common, args: &Sequence, streams: &mut Streams) -> Result<Exit, Fault> {
    let preset_file = preset_file(common, args)?;
    preset_file.warnings.iter().for_each(|warning| streams.note(warning));
    let schedule = Schedule::of(args, &preset_file.preset)?;
    check_template(args, &schedule)?;
    let scene = scene_of(&preset_file)?;
    scene.notes.iter().for_each(|note| streams.note(note));
    let mut painter = Painter::open(common, streams)?;
    let mut shots = shots(args, &preset_file, &scene, &schedule, &painter)?;
    survey(common, &mut shots, preset_file.preset.output.size, &painter, streams)?;
    let mut film = film(common, args, &preset_file, &schedule, &shots, &painter)?;
    if film.is_none() {
        // The film is there already, and nothing else may want a frame.
        shots.iter_mut().filter(|shot| shot.path.is_none()).for_each(|shot| shot.kept = true);
    }
    let kept = shots.iter().filter(|shot| shot.kept).count();
    let of = |shot: &Shot| at(&preset_file, &schedule, shot.frame);
    draw(&shots, &of, preset_file.preset.output.size, &scene, &mut painter, &mut film, streams)?;
    if let Some(film) = film {
        film.finish()?;
    }
    let drawn = shots.len() - kept;
    let range = if shots.len() < schedule.total as usize {
        format!(" of {}..{} of {}", schedule.frames.start, schedule.frames.end, schedule.total)
    } else {
        String::new()
    };
    streams.note(&format!("{drawn} {} drawn, {kept} kept{range}", if drawn == 1 { "frame" } else { "frames" }));
    tell(args, &shots, &schedule, &painter, streams)?;
    Ok(Exit::Done)
}

/// The preset with `--size` and `--tier`, which are short for `--set`.
fn preset_file(common: &Common, args: &Sequence) -> Result<PresetFile, Fault> {
    let mut preset_file = open(common, &args.preset_file)?;
    if let Some(size) = args.size {
        preset_file.preset.output.size = size;
    }
    if let Some(tier) = &args.tier {
        preset_file::set(&mut preset_file, "accuracy.tier", tier)?;
    }
    let [width, height] = preset_file.preset.output.size;
    if width == 0 || height == 0 {
        return Err(Fault::usage(format!("a picture of {width}x{height} pixels has none, and PNG cannot hold it")));
    }
    Ok(preset_file)
}

fn check_template(args: &Sequence, schedule: &Schedule) -> Result<(), Fault> {
    let Some(template) = &args.output else { return Ok(()) };
    if template == "-" {
        return Err(Fault::usage("-o -: a sequence is many files; --apng FILE makes it one"));
    }
    if files::has_number(template)? {
        return Err(Fault::usage(format!("{template}: frames are numbered with {{frame}}; {{n}} would never find the finished ones")));
    }
    if !files::has_frame(template)? && schedule.total > 1 {
        return Err(Fault::usage(format!("{template}: {} frames need {{frame}} in the name", schedule.total)));
    }
    Ok(())
}

fn shots(args: &Sequence, preset_file: &PresetFile, scene: &Scene, schedule: &Schedule, painter: &Painter) -> Result<Vec<Shot>, Fault> {
    let (scene, names) = (scene_hash(scene), render::names(preset_file, painter));
    let shot = |frame| {
        let names = Names { frame: Some(frame), ..names.clone() };
        let path = args.output.as_ref().map(|template| files::frame_path(template, &names)).transpose()?;
        Ok(Shot { frame, mark: mark(&at(preset_file, schedule, frame).preset, scene), path, kept: false })
    };
    schedule.frames.clone().into_par_iter().map(shot).collect()
}

/// The preset as a frame shows it.
fn at(preset_file: &PresetFile, schedule: &Schedule, frame: u32) -> PresetFile {
    let mut preset_file = preset_file.clone();
    preset_file.preset.clock.time_s = schedule.time_s(frame);
    preset_file
}

/// All that decides the picture but who draws it: the look at its time, the scene's bytes, and this program.
fn mark(preset: &Preset, scene: Fnv) -> String {
    // Where the scene lies differs from machine to machine; its bytes decide.
    let anywhere = Preset { scene: SceneSource::Builtin(String::new()), ..preset.clone() };
    let hashes = [preset_hash(&anywhere).0, scene.0];
    let hash = hashes.iter().fold(Fnv::new().bytes(env!("CARGO_PKG_VERSION").as_bytes()), |hash, part| hash.bytes(&part.to_le_bytes()));
    hex(hash)
}

/// Finds the finished frames. A file that is something else is overwritten with `--force` alone.
fn survey(common: &Common, shots: &mut [Shot], size: [u32; 2], painter: &Painter, streams: &Streams) -> Result<(), Fault> {
    if let Some(folder) = shots.first().and_then(|shot| shot.path.as_deref()).and_then(Path::parent).filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|e| Fault::from(e).during(format!("{} cannot be made", folder.display())))?;
    }
    shots.first().and_then(|shot| shot.path.as_deref()).into_iter().for_each(preset_file::remove_unfinished);
    let found: Vec<FrameStatus> = shots
        .par_iter()
        .map(|shot| shot.path.as_ref().map_or(Ok(FrameStatus::Absent), |path| preset_file::frame_status(path, size, &shot.mark)))
        .collect::<Result<_, PresetError>>()?;
    let others: Vec<&Path> =
        shots.iter().zip(&found).filter(|(_, found)| **found == FrameStatus::Other).filter_map(|(shot, _)| shot.path.as_deref()).collect();
    if let ([first, rest @ ..], false) = (&others[..], common.force) {
        let more = if rest.is_empty() { String::new() } else { format!(", and so do {} more", rest.len()) };
        let first = first.display();
        return Err(Fault::usage(format!("{first} exists and is no frame of this preset{more}; --force overwrites")));
    }
    let mut strangers: Vec<&str> = Vec::new();
    for (shot, found) in shots.iter_mut().zip(&found) {
        let FrameStatus::Finished { adapter } = found else { continue };
        let is_ours = adapter == painter.name();
        shot.kept = is_ours || !common.force;
        if !is_ours && shot.kept && !strangers.contains(&adapter.as_str()) {
            strangers.push(adapter);
        }
    }
    if !strangers.is_empty() {
        streams.note(&format!("some of the kept frames were drawn by {}; --force draws those again", strangers.join(", ")));
    }
    Ok(())
}

/// Opens the film, if one is wanted and not there already.
fn film(
    common: &Common,
    args: &Sequence,
    preset_file: &PresetFile,
    schedule: &Schedule,
    shots: &[Shot],
    painter: &Painter,
) -> Result<Option<AnimatedPng>, Fault> {
    let Some(path) = &args.apng else { return Ok(None) };
    let clock = preset_file.preset.clock;
    let delay_s = delay(schedule.fps);
    let reel = AnimationOptions { size: preset_file.preset.output.size, frames: shots.len() as u32, delay_s, is_looping: clock.is_looping };
    let whole = shots.iter().fold(Fnv::new(), |hash, shot| hash.bytes(shot.mark.as_bytes()));
    let mark = hex(whole.words(&[delay_s[0].into(), delay_s[1].into(), clock.is_looping.into()]));
    match preset_file::frame_status(path, reel.size, &mark)? {
        FrameStatus::Finished { adapter } if adapter == painter.name() => return Ok(None),
        FrameStatus::Finished { .. } | FrameStatus::Other if !common.force => {
            return Err(Fault::usage(format!("{} exists; --force overwrites it", path.display())));
        }
        _ => {}
    }
    Ok(Some(AnimatedPng::begin(path, &reel, preset_file, &painter.provenance(), &mark)?))
}

/// One frame's time as a fraction of seconds that APNG can hold, as near as it comes.
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

/// Draws what is not kept, a batch at a time: drawing is one after the other on one device, packing is not.
fn draw(
    shots: &[Shot],
    preset_of: &(impl Fn(&Shot) -> PresetFile + Sync),
    size: [u32; 2],
    scene: &Arc<Scene>,
    painter: &mut Painter,
    film: &mut Option<AnimatedPng>,
    streams: &Streams,
) -> Result<(), Fault> {
    let bar = streams.progress(shots.len() as u64);
    let provenance = painter.provenance();
    let frame_bytes = 4 * u64::from(size[0]) * u64::from(size[1]);
    let batch = (BATCH_BYTES / frame_bytes.max(1)).clamp(1, rayon::current_num_threads() as u64) as usize;
    for shots in shots.chunks(batch) {
        let mut drawn: Vec<Option<Frame>> = Vec::new();
        for shot in shots {
            bar.set_message(shot.path.as_ref().map_or_else(|| format!("frame {}", shot.frame), |path| path.display().to_string()));
            drawn.push(if !shot.kept { Some(painter.frame(&preset_of(shot).preset, scene)?) } else { None });
            bar.inc(1);
        }
        shots.par_iter().zip(&drawn).try_for_each(|(shot, frame)| match (&shot.path, frame) {
            (Some(path), Some(frame)) => files::write(path, &preset_file::png_of_frame(frame, &preset_of(shot), &provenance, &shot.mark)?),
            _ => Ok(()),
        })?;
        let Some(film) = film.as_mut() else { continue };
        for (shot, frame) in shots.iter().zip(drawn) {
            match (frame, &shot.path) {
                (Some(frame), _) => film.push(&frame.color)?,
                (None, Some(path)) => film.push(&preset_file::png_pixels(path)?.0)?,
                (None, None) => unreachable!("a frame without a file is drawn for the film"),
            }
        }
    }
    bar.finish_and_clear();
    Ok(())
}

fn tell(args: &Sequence, shots: &[Shot], schedule: &Schedule, painter: &Painter, streams: &mut Streams) -> Result<(), Fault> {
    if streams.json {
        let file = |path: Option<&Path>| path.map_or(Value::Null, |path| json!(path.to_string_lossy()));
        let row = |shot: &Shot| {
            json!({
                "frame": shot.frame, "time_s": schedule.time_s(shot.frame), "file": file(shot.path.as_deref()),
                "kept": shot.kept, "mark": shot.mark,
            })
        };
        let apng = args.apng.iter().map(|path| json!({ "apng": file(Some(path)), "frames": shots.len(), "fps": schedule.fps }));
        let results = shots.iter().map(row).chain(apng).collect();
        streams.object("sequence", painter.json(), results)?;
        return Ok(());
    }
    let drawn = shots.iter().filter(|shot| !shot.kept).filter_map(|shot| shot.path.as_deref());
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
        Sequence { preset_file: String::new(), output: None, apng: None, from, to, fps, frames, size: None, tier: None }
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
