//! Jobs: work that would make the window stutter, on other threads: loading scenes, judging
//! pictures, drawing thumbnails, saving pictures, waiting for file dialogs.

pub mod background;
pub mod computing;
pub mod film;
pub mod finished;
#[cfg(target_arch = "wasm32")]
mod in_page;
pub mod memory;
#[cfg(not(target_arch = "wasm32"))]
mod on_threads;
pub mod threads;
#[cfg(target_arch = "wasm32")]
pub mod worker;

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
    sync::{Arc, mpsc},
    thread::JoinHandle,
};

use eframe::egui;

use self::computing::{Computing, Count};
use crate::{
    app::{
        files::{
            command::{Origin, Purpose},
            completion::Listing,
            live::Reload,
            scene_loader::SceneKey,
            system_dialog,
        },
        picture::{
            cells::{self, CellOf, CellResult, Cells},
            command::Probed,
            findings::Findings,
            golden_check::GoldenCheck,
            precision::Measured,
            review,
            screen::Inputs,
            tier_times::{self, TierDrawing, Timed},
        },
        trade::point::Point,
    },
    effect_files::{self, EffectError},
    effects::{Effect, Stack},
    frame::Geometry,
    gpu::{Capture, CompileWatch, Gpu, Renderer},
    host::disk,
    oracle,
    preset::{AccuracyRequest, Preset, SceneSource},
    preset_file::{self, Existing, PresetFile, Provenance},
    scene::{Bounds, Scene, view::View},
    shader::key::KernelKey,
    work::Work,
};

/// Finished work. Errors are sentences for people.
pub enum Done {
    Scene(SceneKey, Result<Arc<Scene>, String>),
    /// A scene whose loading was canceled.
    Canceled,
    /// The box of a scene, without a room.
    SceneBox(SceneSource, Result<Bounds, String>),
    /// The verdict on a picture; none if the judgement was canceled.
    Verdict(
        Box<Inputs>,
        Arc<Work>,
        Result<Option<Box<Findings>>, String>,
    ),
    /// A small picture.
    Cell(CellOf, CellResult),
    /// Measured combinations of accuracy options.
    Trade(Result<Vec<Point>, String>),
    Thumbnail(String, Option<egui::ColorImage>),
    /// The thumbnail of a preset on the user's own scene.
    ThumbnailOn(SceneKey, String, Option<egui::ColorImage>),
    /// The picture of an effect on the open model; none if it was cancelled or cannot be drawn.
    EffectPicture(String, Option<egui::ColorImage>),
    /// The favorites were written.
    Favorites(Result<(), String>),
    Export(PathBuf, Result<(), String>),
    Film(Arc<film::Progress>, Result<film::Finished, film::Failure>),
    /// Files that a page was given, which lie in its memory now.
    #[cfg(target_arch = "wasm32")]
    Given(Result<crate::app::shell::page::Given, String>),
    /// How the system's file dialog ended.
    Path(Purpose, system_dialog::Answer),
    /// What is in a folder.
    Folder(Listing),
    /// Which recent files are not there.
    Missing(HashSet<PathBuf>),
    /// Pipelines for what was changed on disk.
    Compiled(Reload, Result<(), String>),
    /// The f32 errors of the user's effects in a picture; none if the measurement was cancelled.
    Precision(Box<Inputs>, Result<Option<Box<Measured>>, String>),
    /// What was told of a pixel.
    Probed(Result<Box<Probed>, String>),
    /// A tier of the open picture was timed.
    TierTime(Box<Timed>),
    /// The golden of a preset, compared again, by the number of its request; none if the preset has
    /// no golden.
    Golden(u64, Option<GoldenCheck>),
    /// A preset of the review beside its golden; none if they are the same.
    Reviewed(String, Result<Option<Arc<review::Drawn>>, String>),
    /// The golden of a preset was accepted.
    Blessed(String, Result<(), String>),
    /// The file of a new effect.
    EffectWritten(PathBuf, Origin, Result<(), String>),
    /// The text of an effect file that is to be edited.
    Code(PathBuf, Result<String, String>),
    /// The text of an effect as it was typed, and what it is read as.
    CodeTried(PathBuf, String, Result<Arc<Effect>, EffectError>),
    /// The text of an effect file that was to be written.
    CodeSaved(PathBuf, String, Result<(), String>),
    /// A file that could not be opened in the user's editor.
    NoEditor(PathBuf, String),
    /// A link to a page, and why it does not carry the bits of its picture, if it does not.
    Link(String, Option<String>),
}

/// Starts threads and receives their results.
pub struct Jobs {
    ctx: egui::Context,
    sender: mpsc::Sender<Done>,
    receiver: mpsc::Receiver<Done>,
    computing: Count,
}

impl Jobs {
    pub fn new(ctx: egui::Context) -> Self {
        let (sender, receiver) = mpsc::channel();
        Self {
            ctx,
            sender,
            receiver,
            computing: Count::default(),
        }
    }

    /// The next finished piece of work, if any.
    pub fn next(&self) -> Option<Done> {
        self.receiver.try_recv().ok()
    }

    /// True while a job keeps the processor busy: times that are measured meanwhile are not those
    /// of a picture at rest.
    pub fn is_computing(&self) -> bool {
        self.computing.is_any()
    }

    /// Starts work that keeps the processor busy.
    fn spawn(&self, name: &str, work: impl FnOnce() -> Done + Send + 'static) {
        self.spawn_waiting(name, || async { work() });
    }

    /// The same for work that waits for a device meanwhile.
    fn spawn_waiting<F: Future<Output = Done> + 'static>(
        &self,
        name: &str,
        work: impl FnOnce() -> F + Send + 'static,
    ) {
        let computing = self.busy();
        self.spawn_idle(name, move || async {
            let _computing = computing;
            work().await
        });
    }

    /// Starts work that mostly waits. None if no thread could be started, or in a page.
    fn spawn_idle<F: Future<Output = Done> + 'static>(
        &self,
        name: &str,
        work: impl FnOnce() -> F + Send + 'static,
    ) -> Option<JoinHandle<()>> {
        let (sender, ctx) = (self.sender.clone(), self.ctx.clone());
        let started = threads::start(name, move || async move {
            // The window may be closed by now; then the result is dropped.
            if sender.send(work().await).is_ok() {
                ctx.request_repaint();
            }
        });
        started
            .inspect_err(|error| {
                eprintln!("rasterlab: no thread could be started for {name}: {error}")
            })
            .ok()
            .flatten()
    }

    /// Loads a scene as `work`.
    pub fn load_scene(&self, key: SceneKey, work: Arc<Work>) {
        self.spawn("scene", move || {
            let preset = Preset {
                scene: key.source.clone(),
                parts: key.parts.clone(),
                room: key.room,
                ground: key.ground,
                surroundings: key.surroundings.clone(),
                ..Preset::default()
            };
            let beside = [None, key.beside.as_deref()];
            let load =
                || preset_file::load_scene_beside(&preset, beside).map_err(|e| e.to_string());
            let scene = giving_back(|| {
                caught("loading the scene", || {
                    background::compute(|| work.run(load)).transpose()
                })
            });
            match scene.transpose() {
                Some(scene) => Done::Scene(key, scene),
                None => Done::Canceled,
            }
        });
    }

    /// Finds the box of a scene.
    pub fn measure_scene(&self, source: SceneSource) {
        self.spawn("scene box", move || {
            let bounds = caught("measuring a scene", || {
                preset_file::scene_bounds(&source, None).map_err(|e| e.to_string())
            });
            Done::SceneBox(source, bounds)
        });
    }

    /// Draws `inputs` with a second renderer, reads everything back and judges it with the oracle.
    pub fn verify(&self, gpu: Arc<Gpu>, inputs: Inputs, work: Arc<Work>) {
        self.spawn_waiting("verify", move || async move {
            let judged = caught_future("judging the picture", verify(gpu, &inputs, &work)).await;
            memory::give_back();
            Done::Verdict(Box::new(inputs), work, judged)
        });
    }

    /// Compiles what `inputs` need, with the shaders as they are on disk now.
    pub fn compile(&self, gpu: Arc<Gpu>, inputs: Inputs, reload: Reload) {
        self.spawn_waiting("compile", move || async move {
            let compiled = caught_future("compiling", compile(gpu, &inputs)).await;
            Done::Compiled(reload, compiled)
        });
    }

    /// Looks into a pixel of a picture with this geometry.
    pub fn probe(&self, of: Inputs, geometry: Arc<Geometry>, pixel: [u32; 2]) {
        self.spawn("probe", move || {
            let look = || {
                let Inputs {
                    scene, view, stack, ..
                } = &of;
                let samples = oracle::probe(scene, view, stack, &geometry, &[pixel])
                    .map_err(|error| error.to_string())?;
                let texts = samples
                    .iter()
                    .map(|sample| sample.text(geometry.subpixel_bits));
                Ok(texts.collect::<String>())
            };
            let told = caught("looking into a pixel", || background::compute(look));
            Done::Probed(told.map(|text| Box::new(Probed { of, pixel, text })))
        });
    }

    /// Times a tier of the open picture. It does not count as work that would be measured: it stops
    /// before such work.
    pub fn time_tier(
        &self,
        gpu: Arc<Gpu>,
        inputs: Inputs,
        kernel: KernelKey,
        drawing: TierDrawing,
        watch: Arc<CompileWatch>,
    ) -> Option<JoinHandle<()>> {
        self.spawn_idle("tier", move || async move {
            let (picture, mut drawing) = (inputs, drawing);
            let measured = tier_times::measure(&gpu, &picture, &mut drawing, &watch);
            let outcome = caught_future("timing a tier", measured).await;
            Done::TierTime(Box::new(Timed {
                picture,
                kernel,
                outcome,
                drawing,
            }))
        })
    }

    /// Writes the file of a new effect.
    pub fn write_effect(
        &self,
        path: PathBuf,
        origin: Origin,
        write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
    ) {
        self.spawn("new effect", move || {
            let outcome = caught("writing the effect", || write(&path));
            Done::EffectWritten(path, origin, outcome)
        });
    }

    /// Reads the text of an effect file.
    pub fn read_code(&self, path: PathBuf) {
        self.spawn("effect text", move || {
            let text = match disk::size_of(&path) {
                Ok(Some(size)) if size > effect_files::MAX_BYTES as u64 => Err(format!(
                    "it has {size} bytes; an effect has at most {}",
                    effect_files::MAX_BYTES
                )),
                _ => disk::read_to_string(&path)
                    .map_err(|error| format!("it cannot be read: {error}")),
            };
            let text = text.map_err(|reason| format!("{}: {reason}", path.display()));
            Done::Code(path, text)
        });
    }

    /// Reads an effect from a text that was typed.
    pub fn try_code(&self, path: PathBuf, text: String) {
        self.spawn("effect typed", move || {
            let file = path.file_name().unwrap_or_default().to_string_lossy();
            let stem = effect_files::stem(&path);
            let read = effect_files::read_beside(&file, &stem, &text, path.parent());
            Done::CodeTried(path, text, read)
        });
    }

    /// Writes the text of an effect file.
    pub fn save_code(&self, path: PathBuf, text: String) {
        self.spawn("effect file", move || {
            let saved = preset_file::write_atomically(&path, text.as_bytes(), Existing::Replace)
                .map_err(|error| format!("{}: it cannot be written: {error}", path.display()));
            Done::CodeSaved(path, text, saved)
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
        let failed = match std::process::Command::new(opener)
            .arg(&path)
            .stdin(std::process::Stdio::null())
            .spawn()
        {
            Ok(mut child) => {
                let sender = (self.sender.clone(), self.ctx.clone());
                std::thread::spawn(move || {
                    // Some systems start the editor as a part of the opener, so this may take as
                    // long as it is open. The explorer of Windows always
                    // reports a failure.
                    if !cfg!(windows)
                        && let Ok(status) = child.wait()
                        && !status.success()
                        && sender
                            .0
                            .send(Done::NoEditor(
                                path,
                                format!("{opener} ended with {status}"),
                            ))
                            .is_ok()
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

    /// Writes the favorites with this function.
    pub fn write_favorites(&self, write: impl FnOnce() -> Result<(), String> + Send + 'static) {
        self.spawn("favorites", move || {
            Done::Favorites(caught("writing the favorites", write))
        });
    }

    /// Draws small pictures on the device of the picture and hands over one after another.
    pub fn draw_cells(&self, gpu: Arc<Gpu>, cells: Cells) {
        let (sender, ctx, computing) = (self.sender.clone(), self.ctx.clone(), self.busy());
        let work = move || async move {
            let _computing = computing;
            let take = |of, picture| {
                // The window may be closed by now; then the picture is dropped.
                if sender.send(Done::Cell(of, picture)).is_ok() {
                    ctx.request_repaint();
                }
            };
            let draw = async {
                cells::draw(&gpu, &cells, take).await;
                Ok(())
            };
            if let Err(error) = caught_future("drawing a small picture", draw).await {
                eprintln!("rasterlab: {error}");
            }
        };
        if let Err(error) = threads::start("cells", work) {
            eprintln!("rasterlab: no thread could be started for small pictures: {error}");
        }
    }

    /// Draws `inputs` and writes a PNG that contains the preset.
    pub fn export(&self, gpu: Arc<Gpu>, inputs: Inputs, preset_file: PresetFile, path: PathBuf) {
        self.spawn_waiting("export", move || async move {
            let exported = export(gpu, &inputs, &preset_file, &path);
            let saved = caught_future("saving the picture", exported).await;
            Done::Export(path, saved)
        });
    }

    /// Draws a film on a second device of the window's adapter.
    pub fn export_film(
        &self,
        window: Arc<Gpu>,
        scene: Arc<Scene>,
        preset_file: PresetFile,
        request: film::Request,
        progress: Arc<film::Progress>,
    ) {
        let ctx = self.ctx.clone();
        self.spawn_waiting("film", move || async move {
            let work = async {
                let exported = film::export(window, scene, preset_file, &request, &progress, &ctx);
                Ok(exported.await)
            };
            let ended = caught_future("drawing the film", work).await;
            memory::give_back();
            let ended = ended.unwrap_or_else(|bug| Err(film::Failure::Other(bug)));
            Done::Film(progress, ended)
        });
    }

    /// Counts work on another thread, which keeps the processor busy, for as long as what is
    /// returned exists.
    pub fn busy(&self) -> Computing {
        self.computing.add()
    }

    /// Shows the system's file dialog.
    pub fn ask_path(&self, purpose: Purpose, start: &Path) {
        let show = system_dialog::prepare(purpose, start);
        self.spawn_idle("file dialog", move || async move {
            Done::Path(purpose, show().await)
        });
    }

    /// Reads what is in a folder.
    pub fn list_folder(&self, folder: PathBuf) {
        self.spawn_idle("folder", move || async move {
            Done::Folder(Listing::read(&folder))
        });
    }

    /// Looks which of these files are not there.
    pub fn find_missing(&self, files: Vec<PathBuf>) {
        self.spawn_idle("recent files", move || async move {
            Done::Missing(
                files
                    .into_iter()
                    .filter(|file| !disk::exists(file))
                    .collect(),
            )
        });
    }
}

/// Runs `work`, and gives back the memory that it has freed.
fn giving_back<T>(work: impl FnOnce() -> T) -> T {
    let done = work();
    memory::give_back();
    done
}

/// Runs `work`. A panic becomes an error, so that the window does not wait for a result that never
/// comes.
fn caught<T>(what: &str, work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(work)).unwrap_or_else(|_| Err(bug(what)))
}

/// The same for work that waits.
async fn caught_future<T>(
    what: &str,
    work: impl Future<Output = Result<T, String>>,
) -> Result<T, String> {
    let done = threads::caught(work).await;
    done.unwrap_or_else(|_| Err(bug(what)))
}

fn bug(what: &str) -> String {
    format!("{what} failed because of a bug; see the terminal for details")
}

/// Draws `inputs` with a second renderer; all renderers of a device share their pipelines.
async fn compile(
    gpu: Arc<Gpu>,
    Inputs {
        scene,
        view,
        stack,
        accuracy,
    }: &Inputs,
) -> Result<(), String> {
    let mut renderer = Renderer::new(gpu);
    renderer.set_scene(scene).await.map_err(|e| e.to_string())?;
    renderer
        .draw(view, stack, accuracy)
        .await
        .map_err(|e| e.to_string())
}

/// Draws `inputs` and judges the picture; none if `work` was canceled.
async fn verify(
    gpu: Arc<Gpu>,
    inputs: &Inputs,
    work: &Arc<Work>,
) -> Result<Option<Box<Findings>>, String> {
    let Inputs {
        scene,
        view,
        stack,
        accuracy,
    } = inputs;
    work.begin("drawing");
    let mut renderer = Renderer::new(gpu);
    renderer.set_scene(scene).await.map_err(|e| e.to_string())?;
    let capture = renderer
        .capture(view, stack, accuracy)
        .await
        .map_err(|e| e.to_string())?;
    drop(renderer);
    background::compute(|| work.run(|| judge(inputs, capture, work))).transpose()
}

fn judge(
    Inputs {
        scene,
        view,
        stack,
        accuracy,
    }: &Inputs,
    capture: Capture,
    work: &Work,
) -> Result<Box<Findings>, String> {
    let judged = effect_files::crossings(stack, |stack| {
        oracle::judge(scene, view, stack, &capture.picture())
    });
    let (verdict, crossings) = judged.map_err(|e| e.to_string())?;
    work.begin("the reference picture");
    let reference = if stack.is_repeatable() {
        Some(reference_ids(scene, view, stack, accuracy)?)
    } else {
        None
    };
    verdict
        .map(|verdict| Box::new(Findings::new(capture, verdict, reference, crossings)))
        .map_err(|e| e.to_string())
}

/// Triangle ids of all pixels in the exact picture on the finest grid.
fn reference_ids(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Result<Vec<u32>, String> {
    let factor = accuracy.scale().factor();
    let frame = oracle::render_finest(scene, &view.scaled(factor), &stack.scaled(factor))
        .map_err(|e| e.to_string())?;
    Ok(frame.triangle_id)
}

/// A scene with more triangles gets no thumbnail: it would take too long.
const THUMBNAIL_TRIANGLES: u64 = 400_000;

/// A look on the scene of `own`, before a camera that shows all of it. None if the scene of the
/// look cannot be measured.
fn landed(look: &PresetFile, own: &PresetFile, scene: &Scene) -> Option<PresetFile> {
    let fit = match look.needs_fit() {
        true => look.fit_to(
            own,
            [
                &preset_file::scene_bounds(&look.scene_source(), None).ok()?,
                &scene.content_bounds(),
            ],
            Some(scene),
        ),
        false => None,
    };
    let mut landed = look.landed_on(own, fit.as_ref());
    // The whole model is shown, so that the picture stays right when the camera moves.
    landed.preset.camera = None;
    landed.map_missing_parts(scene);
    Some(landed)
}

/// The same as RGBA, row by row from the top.
fn small_picture(preset: &Preset, scene: &Scene, size: [u32; 2]) -> Option<Vec<[u8; 4]>> {
    if scene.triangle_count() > THUMBNAIL_TRIANGLES {
        return None;
    }
    let factor = preset.accuracy.scale().factor();
    let frame = oracle::render_scaled(scene, &preset.moments(scene, size), factor).ok()?;
    Some(frame.color)
}

async fn export(
    gpu: Arc<Gpu>,
    Inputs {
        scene,
        view,
        stack,
        accuracy,
    }: &Inputs,
    preset_file: &PresetFile,
    path: &std::path::Path,
) -> Result<(), String> {
    let provenance = Provenance {
        adapter: gpu.summary.name.clone(),
        driver: gpu.summary.driver.clone(),
    };
    let mut renderer = Renderer::new(gpu);
    renderer.set_scene(scene).await.map_err(|e| e.to_string())?;
    let moments = [(view.clone(), stack.clone())];
    let still = renderer
        .still(&moments, accuracy)
        .await
        .map_err(|e| e.to_string())?;
    let png = preset_file::png_with_preset(&still, &preset_file.for_picture(path), &provenance)
        .map_err(|e| e.to_string())?;
    preset_file::write_atomically(path, &png, Existing::Replace).map_err(|e| e.to_string())
}
