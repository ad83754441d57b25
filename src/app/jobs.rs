//! Jobs: work that would make the window stutter, on other threads: loading scenes, judging pictures, drawing thumbnails,
//! saving pictures, waiting for file dialogs.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc,
    },
};

use eframe::egui;

use super::{
    command::{Origin, Purpose},
    findings::Findings,
    golden_check::{self, GoldenCheck},
    live::Reload,
    precision::{self, Measured},
    scene_loader::SceneKey,
    screen::Inputs,
    sweep::{
        measure,
        point::Point,
        request::{Progress, Request},
    },
};
use crate::{
    effect_files,
    effects::Stack,
    gpu::{Gpu, Renderer},
    oracle,
    preset::{AccuracyRequest, Preset},
    preset_file::{self, Existing, PresetFile, Provenance},
    scene::{Scene, view::View},
};

/// Finished work. Errors are sentences for people.
pub enum Done {
    Scene(SceneKey, Result<Arc<Scene>, String>),
    Verdict(Box<Inputs>, Result<Box<Findings>, String>),
    /// Measured combinations of accuracy options.
    Sweep(Result<Vec<Point>, String>),
    Thumbnail(String, Option<egui::ColorImage>),
    Export(PathBuf, Result<(), String>),
    /// The path from the system's file dialog; none if it was canceled or could not be shown.
    Path(Purpose, Option<PathBuf>),
    /// Pipelines for what was changed on disk.
    Compiled(Reload, Result<(), String>),
    /// The f32 errors of the user's effects in a picture; none if the measurement was cancelled.
    Precision(Box<Inputs>, Result<Option<Box<Measured>>, String>),
    /// The golden of a preset, compared again, by the number of its request; none if the preset has no golden.
    Golden(u64, Option<GoldenCheck>),
    /// The file of a new effect.
    EffectWritten(PathBuf, Origin, Result<(), String>),
    /// A file that could not be opened in the user's editor.
    NoEditor(PathBuf, String),
}

/// Starts threads and receives their results.
pub struct Jobs {
    ctx: egui::Context,
    sender: mpsc::Sender<Done>,
    receiver: mpsc::Receiver<Done>,
    /// Jobs that keep the processor busy.
    computing: Arc<AtomicUsize>,
}

impl Jobs {
    pub fn new(ctx: egui::Context) -> Self {
        let (sender, receiver) = mpsc::channel();
        Self { ctx, sender, receiver, computing: Arc::default() }
    }

    /// The next finished piece of work, if any.
    pub fn next(&self) -> Option<Done> {
        self.receiver.try_recv().ok()
    }

    /// True while a job keeps the processor busy: times that are measured meanwhile are not those of a picture at rest.
    pub fn is_computing(&self) -> bool {
        self.computing.load(Ordering::Relaxed) > 0
    }

    /// Starts work that keeps the processor busy.
    fn spawn(&self, name: &str, work: impl FnOnce() -> Done + Send + 'static) {
        let computing = Computing::new(&self.computing);
        self.spawn_idle(name, move || {
            let _computing = computing;
            work()
        });
    }

    /// Starts work that only waits.
    fn spawn_idle(&self, name: &str, work: impl FnOnce() -> Done + Send + 'static) {
        let (sender, ctx) = (self.sender.clone(), self.ctx.clone());
        let started = std::thread::Builder::new().name(name.into()).spawn(move || {
            // The window may be closed by now; then the result is dropped.
            if sender.send(work()).is_ok() {
                ctx.request_repaint();
            }
        });
        if let Err(error) = started {
            eprintln!("rasterlab: no thread could be started for {name}: {error}");
        }
    }

    pub fn load_scene(&self, key: SceneKey) {
        self.spawn("scene", move || {
            let preset = Preset { scene: key.source.clone(), room: key.room, ..Preset::default() };
            let scene =
                caught("loading the scene", || preset_file::load_scene(&preset, key.preset_path.as_deref()).map_err(|e| e.to_string()));
            Done::Scene(key, scene)
        });
    }

    /// Draws `inputs` with a second renderer, reads everything back and judges it with the oracle.
    pub fn verify(&self, gpu: Arc<Gpu>, inputs: Inputs) {
        self.spawn("verify", move || {
            let verdict = caught("judging the picture", || verify(gpu, &inputs));
            Done::Verdict(Box::new(inputs), verdict)
        });
    }

    /// Compiles what `inputs` need, with the shaders as they are on disk now.
    pub fn compile(&self, gpu: Arc<Gpu>, inputs: Inputs, reload: Reload) {
        self.spawn("compile", move || {
            let compiled = caught("compiling", || compile(gpu, &inputs));
            Done::Compiled(reload, compiled)
        });
    }

    /// Measures the f32 errors of the user's effects with the oracle.
    pub fn measure_precision(&self, inputs: Inputs, cancelled: Arc<AtomicBool>) {
        self.spawn("precision", move || {
            let measured =
                caught("measuring the f32 error", || precision::measure(&inputs, &cancelled).map(|measured| measured.map(Box::new)));
            Done::Precision(Box::new(inputs), measured)
        });
    }

    /// Draws the golden of a preset again and compares.
    pub fn check_golden(&self, number: u64, preset_file: PresetFile) {
        self.spawn("golden", move || {
            let checked = caught("drawing the golden", || Ok(golden_check::check(&preset_file)));
            Done::Golden(number, checked.ok().flatten())
        });
    }

    /// Writes the file of a new effect.
    pub fn write_effect(&self, path: PathBuf, origin: Origin, write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static) {
        self.spawn("new effect", move || {
            let outcome = caught("writing the effect", || write(&path));
            Done::EffectWritten(path, origin, outcome)
        });
    }

    /// Opens a file in the program that the system has for it.
    pub fn open_editor(&self, path: PathBuf) {
        let opener = if cfg!(windows) {
            "explorer"
        } else if cfg!(target_os = "macos") {
            "open"
        } else {
            "xdg-open"
        };
        let failed = match std::process::Command::new(opener).arg(&path).stdin(std::process::Stdio::null()).spawn() {
            Ok(mut child) => {
                let sender = (self.sender.clone(), self.ctx.clone());
                std::thread::spawn(move || {
                    // Some systems start the editor as a part of the opener, so this may take as long as it is open. The explorer of
                    // Windows always reports a failure.
                    if !cfg!(windows)
                        && let Ok(status) = child.wait()
                        && !status.success()
                        && sender.0.send(Done::NoEditor(path, format!("{opener} ended with {status}"))).is_ok()
                    {
                        sender.1.request_repaint();
                    }
                });
                return;
            }
            Err(error) => format!("{opener}: {error}"),
        };
        // The receiver lives as long as `self`.
        let _ = self.sender.send(Done::NoEditor(path, failed));
        self.ctx.request_repaint();
    }

    /// Measures combinations of accuracy options on a second device, so that the window stays responsive.
    pub fn measure(&self, adapter: String, scene: Arc<Scene>, request: Request, progress: Arc<Progress>) {
        let work = move || measure::measure(adapter, &scene, &request, &progress);
        self.spawn("sweep", || Done::Sweep(caught("measuring the sweep", work)));
    }

    /// Draws the picture of a preset with the oracle, which needs no device.
    pub fn thumbnail(&self, preset_file: PresetFile) {
        self.spawn("thumbnail", move || {
            let image = caught("drawing a thumbnail", || thumbnail(&preset_file).ok_or_else(String::new));
            Done::Thumbnail(preset_file.id, image.ok())
        });
    }

    /// Draws `inputs` and writes a PNG that contains the preset.
    pub fn export(&self, gpu: Arc<Gpu>, inputs: Inputs, preset_file: PresetFile, path: PathBuf) {
        self.spawn("export", move || {
            let saved = caught("saving the picture", || export(gpu, &inputs, &preset_file, &path));
            Done::Export(path, saved)
        });
    }

    /// Shows the system's file dialog.
    pub fn ask_path(&self, purpose: Purpose, start: PathBuf) {
        let mut dialog = rfd::AsyncFileDialog::new();
        if let Some(folder) = start.parent().filter(|folder| folder.is_dir()) {
            dialog = dialog.set_directory(folder);
        }
        let name = start.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        for (label, extensions) in filters(purpose) {
            dialog = dialog.add_filter(*label, extensions);
        }
        let chosen: std::pin::Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match purpose {
            Purpose::Open => Box::pin(dialog.pick_file()),
            Purpose::SaveAs | Purpose::Export => Box::pin(dialog.set_file_name(name).save_file()),
        };
        self.spawn_idle("file dialog", move || Done::Path(purpose, pollster::block_on(chosen).map(|file| file.path().to_owned())));
    }
}

/// Counts a job for as long as it exists.
struct Computing(Arc<AtomicUsize>);

impl Computing {
    fn new(count: &Arc<AtomicUsize>) -> Self {
        count.fetch_add(1, Ordering::Relaxed);
        Self(count.clone())
    }
}

impl Drop for Computing {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// File types of the system's dialog: names and extensions.
const fn filters(purpose: Purpose) -> &'static [(&'static str, &'static [&'static str])] {
    match purpose {
        Purpose::Open => &[("Presets, models, pictures, effects", &["toml", "glb", "gltf", "png", "wgsl"])],
        Purpose::SaveAs => &[("Presets", &["toml"])],
        Purpose::Export => &[("Pictures", &["png"])],
    }
}

/// Runs `work`. A panic becomes an error, so that the window does not wait for a result that never comes.
fn caught<T>(what: &str, work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work))
        .unwrap_or_else(|_| Err(format!("{what} failed because of a bug; see the terminal for details")))
}

/// Draws `inputs` with a second renderer; all renderers of a device share their pipelines.
fn compile(gpu: Arc<Gpu>, Inputs { scene, view, stack, accuracy }: &Inputs) -> Result<(), String> {
    let mut renderer = Renderer::new(gpu);
    renderer.set_scene(scene).map_err(|e| e.to_string())?;
    renderer.draw(view, stack, accuracy).map_err(|e| e.to_string())
}

fn verify(gpu: Arc<Gpu>, Inputs { scene, view, stack, accuracy }: &Inputs) -> Result<Box<Findings>, String> {
    let mut renderer = Renderer::new(gpu);
    renderer.set_scene(scene).map_err(|e| e.to_string())?;
    let capture = renderer.capture(view, stack, accuracy).map_err(|e| e.to_string())?;
    let judged = effect_files::crossings(stack, |stack| oracle::judge(scene, view, stack, &capture.picture()));
    let (verdict, crossings) = judged.map_err(|e| e.to_string())?;
    let reference = if stack.is_repeatable() { Some(reference_ids(scene, view, stack, accuracy)?) } else { None };
    verdict.map(|verdict| Box::new(Findings::new(capture, verdict, reference, crossings))).map_err(|e| e.to_string())
}

/// Triangle ids of all pixels in the exact picture on the finest grid.
fn reference_ids(scene: &Scene, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<Vec<u32>, String> {
    let factor = accuracy.scale().factor();
    let frame = oracle::render_finest(scene, &view.scaled(factor), &stack.scaled(factor)).map_err(|e| e.to_string())?;
    Ok(frame.triangle_id)
}

/// Size of a thumbnail in pixels; shown at half of it.
pub const THUMBNAIL: [u32; 2] = [144, 108];

/// A scene with more triangles gets no thumbnail: it would take too long.
const THUMBNAIL_TRIANGLES: u64 = 400_000;

fn thumbnail(preset_file: &PresetFile) -> Option<egui::ColorImage> {
    let scene = preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref()).ok()?;
    if scene.triangle_count() > THUMBNAIL_TRIANGLES {
        return None;
    }
    let factor = preset_file.preset.accuracy.scale().factor();
    let frame = oracle::render_scaled(&scene, &preset_file.preset.moments(&scene, THUMBNAIL), factor).ok()?;
    let bytes: Vec<u8> = frame.color.concat();
    Some(egui::ColorImage::from_rgba_unmultiplied([frame.width as usize, frame.height as usize], &bytes))
}

fn export(
    gpu: Arc<Gpu>,
    Inputs { scene, view, stack, accuracy }: &Inputs,
    preset_file: &PresetFile,
    path: &std::path::Path,
) -> Result<(), String> {
    let provenance = Provenance { adapter: gpu.summary.name.clone(), driver: gpu.summary.driver.clone() };
    let mut renderer = Renderer::new(gpu);
    renderer.set_scene(scene).map_err(|e| e.to_string())?;
    let capture = renderer.capture(view, stack, accuracy).map_err(|e| e.to_string())?;
    let png =
        preset_file::png_with_preset(&capture.into_shown(), &preset_file.for_picture(path), &provenance).map_err(|e| e.to_string())?;
    preset_file::write_atomically(path, &png, Existing::Replace).map_err(|e| e.to_string())
}
