//! Films that the window exports: what is asked for, how far it is, and the work of drawing it on a
//! device of its own. A page has one device and no files: there the frames are drawn between those
//! of the window, and a film is a download.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, MutexGuard,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use web_time::Instant;

use crate::{
    accuracy::RenderScale,
    film::{
        Container, Film, FilmError, FrameJob, Observer, Outputs, Painter, Production, Schedule,
        Times, Turntable, VideoTarget, frame_paths,
    },
    frame::Frame,
    gpu::{Gpu, RenderError, Renderer, device::AdapterChoice},
    preset::{Clock, Preset},
    preset_file::{PresetFile, Provenance},
    scene::Scene,
};
#[cfg(target_arch = "wasm32")]
use crate::{app::shell::page, archive, host::disk};

const IN_PAGE: bool = cfg!(target_arch = "wasm32");

/// What a film is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A PNG for each frame.
    Frames,
    /// One animated PNG.
    Apng,
    Video(Container),
}

impl Format {
    pub const ALL: [Self; 5] = [
        Self::Frames,
        Self::Apng,
        Self::Video(Container::Mp4),
        Self::Video(Container::Webm),
        Self::Video(Container::Gif),
    ];

    /// The formats that can be written here. A page has no programs beside it.
    pub fn here() -> impl Iterator<Item = Self> {
        let is_here = |format: &Self| !(IN_PAGE && format.needs_ffmpeg());
        Self::ALL.into_iter().filter(is_here)
    }

    pub const fn name(self) -> &'static str {
        match self {
            Self::Frames if IN_PAGE => "PNG frames (ZIP)",
            Self::Frames => "PNG frames",
            Self::Apng => "Animated PNG",
            Self::Video(Container::Mp4) => "MP4",
            Self::Video(Container::Webm) => "WebM",
            Self::Video(Container::Gif) => "GIF",
        }
    }

    /// Its name in the settings file.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Frames => "frames",
            Self::Apng => "apng",
            Self::Video(container) => container.extension(),
        }
    }

    pub const fn extension(self) -> &'static str {
        match self {
            Self::Frames if IN_PAGE => "zip",
            Self::Frames | Self::Apng => "png",
            Self::Video(container) => container.extension(),
        }
    }

    /// Frames of a film that was stopped stay, and the next export goes on after them.
    pub const fn keeps_frames(self) -> bool {
        matches!(self, Self::Frames) && !IN_PAGE
    }

    pub const fn needs_ffmpeg(self) -> bool {
        matches!(self, Self::Video(_))
    }

    /// `path` with the extension of this format; one of another format is replaced.
    pub fn named(self, path: &Path) -> PathBuf {
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some(there) if there == self.extension() => path.to_owned(),
            Some("zip") if IN_PAGE => path.with_extension(self.extension()),
            Some("png" | "apng" | "mp4" | "webm" | "gif") => path.with_extension(self.extension()),
            _ => {
                // Appended, so that `walk.v2` keeps its dot.
                let mut name = path.as_os_str().to_owned();
                name.push(format!(".{}", self.extension()));
                name.into()
            }
        }
    }
}

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    pub format: Format,
    /// The file; of frames, the name before the number.
    pub path: PathBuf,
    /// Width and height, pixels.
    pub size: [u32; 2],
    pub fps: f64,
    /// Begin and end, seconds; the end is not drawn.
    pub range_s: [f64; 2],
    pub turntable: Option<Turntable>,
    /// The preset whose look the first frame has; the last one has its own.
    pub from_look_of: Option<Box<Preset>>,
    /// Drawn per shown pixel; none: as the preset has it.
    pub scale: Option<RenderScale>,
    /// The person agreed to replace what is there.
    pub replaces: bool,
}

impl Request {
    /// The frames of the film.
    ///
    /// # Errors
    /// The times or the rate cannot be.
    pub fn schedule(&self, clock: &Clock) -> Result<Schedule, FilmError> {
        let times = Times {
            from_s: Some(self.range_s[0]),
            to_s: Some(self.range_s[1]),
            fps: match self.format {
                Format::Video(container) => container.fps(self.fps),
                _ => self.fps,
            },
            frames: [None; 2],
        };
        Schedule::new(&times, clock, "")
    }

    /// The files of `schedule`'s frames; empty unless the film is written as frames.
    pub fn frame_paths(&self, schedule: &Schedule) -> Vec<PathBuf> {
        if self.format == Format::Frames {
            frame_paths(&self.path, schedule.frames.clone(), schedule.total)
        } else {
            Vec::new()
        }
    }
}

/// Why a film was not finished.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    Stopped,
    /// Other files are in the way, which the person may agree to replace.
    Taken(String),
    Other(String),
}

impl From<FilmError> for Failure {
    fn from(error: FilmError) -> Self {
        match error {
            FilmError::Stopped => Self::Stopped,
            FilmError::Exists { .. } | FilmError::NotOurs { .. } => Self::Taken(error.to_string()),
            error => Self::Other(error.to_string()),
        }
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        Self::Other(error.to_string())
    }
}

/// How a film ended that was not stopped: frames that were drawn, and frames that were there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finished {
    pub drawn: usize,
    pub kept: usize,
}

/// How far a film is; shared with the thread that draws it.
#[derive(Default)]
pub struct Progress {
    is_stopped: AtomicBool,
    state: Mutex<Counts>,
}

/// Numbers of frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Of the whole film; 0 before it begins.
    pub all: usize,
    /// Drawn or kept.
    pub done: usize,
    /// To be drawn, of the whole film.
    to_draw: usize,
    drawn: usize,
    since: Option<Instant>,
}

impl Counts {
    /// Seconds until the film is done, from the time that its frames have taken; none before the
    /// first is drawn.
    pub fn left_s(&self) -> Option<f64> {
        let since = self.since.filter(|_| self.drawn > 0)?;
        Some(left_s(since.elapsed(), self.drawn, self.to_draw))
    }
}

/// Seconds for the rest of `all` frames, of which `drawn` took `passed`.
fn left_s(passed: Duration, drawn: usize, all: usize) -> f64 {
    passed.as_secs_f64() / drawn as f64 * all.saturating_sub(drawn) as f64
}

impl Progress {
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    pub fn read(&self) -> Counts {
        *self.counts()
    }

    fn counts(&self) -> MutexGuard<'_, Counts> {
        self.state
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

/// Draws the frames of a film on a device of its own, so that the window's pictures do not wait
/// behind them.
struct Studio {
    renderer: Renderer,
    gpu: Arc<Gpu>,
}

impl Painter for Studio {
    type Error = Failure;

    fn provenance(&self) -> Provenance {
        let summary = &self.gpu.summary;
        // As the command line says it: both make the same frames.
        Provenance {
            adapter: summary.name.clone(),
            driver: format!("{} ({})", summary.driver, summary.backend),
        }
    }

    async fn paint(&mut self, preset: &Preset, scene: &Arc<Scene>) -> Result<Frame, Failure> {
        self.renderer.set_scene(scene).await?;
        let moments = preset.moments(scene, preset.output.size);
        Ok(self.renderer.still(&moments, &preset.accuracy).await?)
    }
}

/// Counts frames, and shows them.
struct Counter<'a> {
    progress: &'a Progress,
    ctx: &'a egui::Context,
}

impl Observer for Counter<'_> {
    fn begins(&self, _: &FrameJob) {}

    fn ended(&self, job: &FrameJob) {
        let mut counts = self.progress.counts();
        counts.done += 1;
        counts.drawn += usize::from(!job.is_kept);
        drop(counts);
        self.ctx.request_repaint_after(Duration::from_millis(50));
    }

    fn is_stopped(&self) -> bool {
        self.progress.is_stopped()
    }
}

/// A second device of the window's adapter; in a page the same.
async fn device_beside(window: Arc<Gpu>) -> Result<Arc<Gpu>, Failure> {
    if IN_PAGE {
        return Ok(window);
    }
    Gpu::open(&AdapterChoice::Named(window.summary.name.clone()))
        .await
        .map_err(|error| Failure::Other(error.to_string()))
}

/// Draws the film `request` of a preset with a second device of the adapter of the window's.
///
/// # Errors
/// The film was stopped, or failed for a reason that is a sentence for people.
pub async fn export(
    window: Arc<Gpu>,
    scene: Arc<Scene>,
    mut preset_file: PresetFile,
    request: &Request,
    progress: &Progress,
    ctx: &egui::Context,
) -> Result<Finished, Failure> {
    let preset = &mut preset_file.preset;
    preset.output.resize(request.size);
    if let Some(scale) = request.scale {
        preset.accuracy.pins = preset.accuracy.pins.with(scale);
    }
    preset.accuracy = preset.accuracy.anti_aliased();
    let schedule = request.schedule(&preset.clock)?;
    let mut outputs = Outputs {
        frames: request.frame_paths(&schedule),
        ..Outputs::default()
    };
    #[cfg(target_arch = "wasm32")]
    let gathered = Gathered::begin(&mut outputs.frames);
    match request.format {
        Format::Frames => {}
        Format::Apng => outputs.apng = Some(request.path.clone()),
        Format::Video(_) => outputs.video = Some(VideoTarget::new(&request.path, request.size)?),
    }
    let mut end = None;
    if let Some(look) = &request.from_look_of {
        let [own, look] =
            [&preset_file.preset, &**look].map(|preset| preset.metric(&scene).into_owned());
        end = Some(preset_file.clone());
        preset_file.preset = Preset {
            accuracy: own.accuracy,
            ..own.with_look_of(look)
        };
    }
    let mut film =
        Film::new(preset_file, scene, schedule, request.turntable).map_err(FilmError::from)?;
    if let Some(end) = end {
        film = film.toward(end)?;
    }
    let gpu = device_beside(window).await?;
    let mut studio = Studio {
        renderer: Renderer::new(gpu.clone()),
        gpu,
    };
    let mut production = Production::begin(film, outputs, studio.provenance(), request.replaces)?;
    let (all, kept) = (production.jobs.len(), production.kept());
    *progress.counts() = Counts {
        all,
        to_draw: all - kept,
        since: Some(Instant::now()),
        ..Counts::default()
    };
    production
        .draw(&mut studio, &Counter { progress, ctx })
        .await?;
    #[cfg(target_arch = "wasm32")]
    gathered.download(request).map_err(Failure::Other)?;
    Ok(Finished {
        drawn: all - kept,
        kept,
    })
}

/// The frames that a page has drawn, in memory until it downloads them as one archive.
#[cfg(target_arch = "wasm32")]
struct Gathered;

#[cfg(target_arch = "wasm32")]
impl Gathered {
    /// Has `frames` written to memory.
    fn begin(frames: &mut [PathBuf]) -> Self {
        for frame in frames {
            *frame = Path::new(page::UNPACKED).join(frame.file_name().unwrap_or_default());
        }
        Self
    }

    fn download(self, request: &Request) -> Result<(), String> {
        if request.format != Format::Frames {
            return Ok(());
        }
        let frames = disk::below(Path::new(page::UNPACKED));
        let name = |path: &Path| path.file_name().unwrap_or_default().display().to_string();
        let named: Vec<_> = frames.iter().map(|(path, png)| (name(path), png)).collect();
        let packed = archive::write(named.iter().map(|(name, png)| (name.as_str(), &***png)))?;
        page::download(&request.path, &packed)
    }
}

#[cfg(target_arch = "wasm32")]
impl Drop for Gathered {
    fn drop(&mut self) {
        disk::remove(Path::new(page::UNPACKED));
    }
}

/// `2 min 5 s left`.
pub fn time_left_text(left_s: f64) -> String {
    let seconds = left_s.ceil().clamp(0.0, 1e7) as u64;
    match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
        (0, 0, seconds) => format!("{seconds} s left"),
        (0, minutes, seconds) => format!("{minutes} min {seconds} s left"),
        (hours, minutes, _) => format!("{hours} h {minutes} min left"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_the_extension_of_its_format() {
        let named =
            |format: Format, path: &str| format.named(Path::new(path)).display().to_string();
        let mp4 = Format::Video(Container::Mp4);
        assert_eq!(named(mp4, "a/walk"), "a/walk.mp4");
        assert_eq!(named(mp4, "a/walk.v2"), "a/walk.v2.mp4");
        assert_eq!(named(mp4, "a/walk.PNG"), "a/walk.mp4");
        assert_eq!(named(Format::Apng, "walk.gif"), "walk.png");
        assert_eq!(named(Format::Frames, "walk.png"), "walk.png");
    }

    #[test]
    fn the_time_left_is_that_of_the_frames_to_come() {
        assert!((left_s(Duration::from_secs(10), 5, 20) - 30.0).abs() < 1e-9);
        assert_eq!(left_s(Duration::from_secs(10), 5, 5), 0.0);
        assert_eq!(
            [0.2, 59.5, 125.0, 7300.0].map(time_left_text),
            [
                "1 s left",
                "1 min 0 s left",
                "2 min 5 s left",
                "2 h 1 min left"
            ]
        );
    }
}
