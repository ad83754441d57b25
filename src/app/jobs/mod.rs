//! Jobs: work that would make the window stutter, on other threads: loading scenes, judging
//! pictures, drawing thumbnails, saving pictures, waiting for file dialogs.

pub mod background;
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
    path::{Path, PathBuf},
    sync::{Arc, mpsc},
    thread::JoinHandle,
};

use crate::{
    app::{
        App,
        editing::new_effect,
        files::{
            apply::save_failed,
            command::{Origin, Purpose},
            completion::Listing,
            library, open, reload,
            scene_loader::SceneKey,
            system_dialog,
        },
        picture::{
            apply::take_verdict,
            cells::{self, CellOf, Cells},
            command::Probed,
            findings::Findings,
            screen::Inputs,
            tier_times::{self, TierDrawing, Timed},
        },
        shell::log::Level,
    },
    effect_files,
    effects::Stack,
    frame::Geometry,
    gpu::{Capture, CompileWatch, Gpu, Renderer},
    host::disk,
    oracle,
    preset::{AccuracyRequest, Preset, SceneSource},
    preset_file::{self, Existing, PresetFile, Provenance},
    scene::{Scene, UpAxis, view::View},
    shader::key::KernelKey,
    work::Work,
};

/// What finished work does to the window.
pub type Done = Box<dyn FnOnce(&mut App) + Send>;

/// The same, of a closure.
fn done(take: impl FnOnce(&mut App) + Send + 'static) -> Done {
    Box::new(take)
}

/// Work under way that keeps the processor busy, for as long as this exists: a picture that is
/// measured meanwhile would seem slow.
pub type Computing = Arc<()>;

/// Starts threads and receives their results.
pub struct Jobs {
    ctx: egui::Context,
    sender: mpsc::Sender<Done>,
    receiver: mpsc::Receiver<Done>,
    /// Held once more by all work that keeps the processor busy.
    computing: Computing,
}

impl Jobs {
    pub fn new(ctx: egui::Context) -> Self {
        let (sender, receiver) = mpsc::channel();
        Self {
            ctx,
            sender,
            receiver,
            computing: Computing::default(),
        }
    }

    /// The next finished piece of work, if any.
    pub fn next(&self) -> Option<Done> {
        self.receiver.try_recv().ok()
    }

    /// True while a job keeps the processor busy: times that are measured meanwhile are not those
    /// of a picture at rest.
    pub fn is_computing(&self) -> bool {
        Arc::strong_count(&self.computing) > 1
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
            done(move |app| {
                if let Some(scene) = scene.transpose() {
                    open::take_scene(app, key, scene);
                }
            })
        });
    }

    /// Finds the box of a scene.
    pub fn measure_scene(&self, (source, up): (SceneSource, UpAxis)) {
        self.spawn("scene box", move || {
            let bounds = caught("measuring a scene", || {
                preset_file::scene_bounds(&source, up, None).map_err(|e| e.to_string())
            });
            done(move |app| open::take_bounds(app, (source, up), bounds))
        });
    }

    /// Draws `inputs` with a second renderer, reads everything back and judges it with the oracle.
    pub fn verify(&self, gpu: Arc<Gpu>, inputs: Inputs, work: Arc<Work>) {
        self.spawn_waiting("verify", move || async move {
            let judged = caught_future("judging the picture", verify(gpu, &inputs, &work)).await;
            memory::give_back();
            done(move |app| take_verdict(app, inputs, &work, judged))
        });
    }

    /// Compiles what `inputs` need, with the shaders as they are on disk now; `then` takes the
    /// outcome.
    pub fn compile(
        &self,
        gpu: Arc<Gpu>,
        inputs: Inputs,
        then: impl FnOnce(&mut App, Result<(), String>) + Send + 'static,
    ) {
        self.spawn_waiting("compile", move || async move {
            let compiled = caught_future("compiling", compile(gpu, &inputs)).await;
            done(move |app| then(app, compiled))
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
            let text = caught("looking into a pixel", || background::compute(look));
            done(move |app| match text {
                Ok(text) => app.state.picture.probed = Some(Probed { of, pixel, text }),
                Err(error) => app.notify(Level::Error, error),
            })
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
            done(move |app| {
                let timed = Timed {
                    picture,
                    kernel,
                    outcome,
                    drawing,
                };
                tier_times::take_times(&mut app.state, timed);
            })
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
            done(move |app| new_effect::written(app, path, origin, outcome))
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
            done(move |app| match text {
                Ok(text) => app.panels.code.show(path, text),
                Err(error) => app.notify(Level::Error, error),
            })
        });
    }

    /// Reads an effect from a text that was typed.
    pub fn try_code(&self, path: PathBuf, text: String) {
        self.spawn("effect typed", move || {
            let file = path.file_name().unwrap_or_default().to_string_lossy();
            let stem = effect_files::stem(&path);
            let read = effect_files::read_beside(&file, &stem, &text, path.parent());
            done(move |app| {
                app.panels.code.take_error(&text, read.as_ref().err());
                reload::code_tried(app, &path, read);
            })
        });
    }

    /// Writes the text of an effect file.
    pub fn save_code(&self, path: PathBuf, text: String) {
        self.spawn("effect file", move || {
            let saved = preset_file::write_atomically(&path, text.as_bytes(), Existing::Replace)
                .map_err(|error| format!("{}: it cannot be written: {error}", path.display()));
            done(move |app| match saved {
                Ok(()) => app.panels.code.take_saved(&path, &text),
                Err(error) => app.notify(Level::Error, error),
            })
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
        self.spawn_idle("editor", move || async move {
            // Some systems start the editor as a part of the opener, so this may take as long as it
            // is open. The explorer of Windows always reports a failure.
            let failed = match std::process::Command::new(opener)
                .arg(&path)
                .stdin(std::process::Stdio::null())
                .status()
            {
                Ok(status) if cfg!(windows) || status.success() => None,
                Ok(status) => Some(format!("{opener} ended with {status}")),
                Err(error) => Some(format!("{opener}: {error}")),
            };
            done(move |app| {
                if let Some(reason) = failed {
                    let path = path.display();
                    let text = format!("{path} could not be opened in an editor: {reason}");
                    app.notify(Level::Warning, text);
                }
            })
        });
    }

    /// Writes the favorites with this function.
    pub fn write_favorites(&self, write: impl FnOnce() -> Result<(), String> + Send + 'static) {
        self.spawn("favorites", move || {
            let written = caught("writing the favorites", write);
            done(move |app| {
                app.state.files.favorites.write_ended();
                match written {
                    Ok(()) => library::write_favorites(&mut app.state),
                    Err(error) => app.notify(Level::Error, error),
                }
            })
        });
    }

    /// Draws small pictures on the device of the picture and hands over one after another.
    pub fn draw_cells(&self, gpu: Arc<Gpu>, cells: Cells) {
        let (sender, ctx, computing) = (self.sender.clone(), self.ctx.clone(), self.busy());
        let work = move || async move {
            let _computing = computing;
            let take = |of, picture| {
                let take = done(move |app| {
                    let ctx = &app.ctx;
                    match of {
                        CellOf::Sweep { number, index } => {
                            app.panels.sweep.take_picture(ctx, (number, index), picture)
                        }
                        CellOf::Seed(seed) => app.panels.randomize.take_picture(ctx, seed, picture),
                    }
                });
                // The window may be closed by now; then the picture is dropped.
                if sender.send(take).is_ok() {
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
            done(move |app| match saved {
                Ok(()) => app.notify(Level::Info, format!("Saved {}", path.display())),
                Err(error) => save_failed(app, Purpose::Export, &path, error),
            })
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
            done(move |app| {
                if let Some((level, text)) = app.panels.film.take_end(&progress, ended) {
                    app.notify(level, text);
                }
            })
        });
    }

    /// Counts work on another thread, which keeps the processor busy, for as long as what is
    /// returned exists.
    pub fn busy(&self) -> Computing {
        self.computing.clone()
    }

    /// Shows the system's file dialog.
    pub fn ask_path(&self, purpose: Purpose, start: &Path) {
        let show = system_dialog::prepare(purpose, start);
        self.spawn_idle("file dialog", move || async move {
            let answer = show().await;
            done(move |app| {
                let open = &app.state.session.preset_file;
                app.panels
                    .dialogs
                    .path_arrived(purpose, answer, open, &app.commands)
            })
        });
    }

    /// Reads what is in a folder.
    pub fn list_folder(&self, folder: PathBuf) {
        self.spawn_idle("folder", move || async move {
            let listing = Listing::read(&folder);
            done(move |app| app.panels.dialogs.folder_arrived(listing))
        });
    }

    /// Looks which of these files are not there.
    pub fn find_missing(&self, files: Vec<PathBuf>) {
        self.spawn_idle("recent files", move || async move {
            let missing = files
                .into_iter()
                .filter(|file| !disk::exists(file))
                .collect();
            done(move |app| app.state.files.missing_files = missing)
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
fn land_look(look: &PresetFile, own: &PresetFile, scene: &Scene) -> Option<PresetFile> {
    let fit = match look.needs_fit() {
        true => look.fit_to(
            own,
            [
                &preset_file::scene_bounds(&look.scene_source(), look.preset.parts.up, None)
                    .ok()?,
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
    landed.settle(scene, true);
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
