//! The window in a page: opening it, the files that a person gives to it and takes from it, and what
//! the browser keeps for it.

use std::{
    cell::RefCell,
    io,
    path::{Path, PathBuf},
};

use eframe::web_sys::HtmlCanvasElement;
use js_sys::{Array, Function, Promise, Reflect, Uint8Array};
use wasm_bindgen::{JsCast as _, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, File, HtmlAnchorElement, HtmlInputElement, Response, Storage, Url};

use super::{command::Commands, device::wgpu_setup, log::Level};
use crate::{
    app::{App, Options, files::take_along, settings::last_session::LastSession, window::input},
    archive,
    host::disk,
    link,
    preset_file::{self, PresetFile},
};

/// The folder whose files the browser keeps: settings and session.
pub const KEPT: &str = "/rasterlab";

/// The folder of files that a person has given.
pub const GIVEN: &str = "/given";

/// The folder of files that lie in memory until they are packed.
pub const UNPACKED: &str = "/unpacked";

/// Shows the window on a canvas, and opens the model `then` in it. The browser keeps its settings
/// and its session.
///
/// # Errors
/// If the browser has no WebGPU.
pub async fn start(
    canvas: HtmlCanvasElement,
    options: Options,
    then: Option<PathBuf>,
) -> Result<(), JsValue> {
    disk::keep_with(keep);
    read_kept();
    show(canvas, options, move |_| {
        open_given(then.into_iter().collect());
    })
    .await
}

/// Shows the window whose device was lost on another canvas and a new device, with the session that
/// it kept.
///
/// # Errors
/// If the browser gives no device any more.
pub async fn reopen(canvas: HtmlCanvasElement) -> Result<(), JsValue> {
    if let Some(lost) = RUNNER.take() {
        lost.destroy();
    }
    show(canvas, Options::default(), |app| {
        app.notify(
            Level::Warning,
            "The graphics device was lost. The window was opened again with your preset.",
        );
    })
    .await
}

async fn show(
    canvas: HtmlCanvasElement,
    options: Options,
    then: impl FnOnce(&mut App) + 'static,
) -> Result<(), JsValue> {
    let options = Options {
        config: Some(KEPT.into()),
        ..options
    };
    let wgpu_options = egui_wgpu::WgpuConfiguration {
        wgpu_setup: wgpu_setup(&options.adapter),
        ..Default::default()
    };
    // Dithering would change the bytes that the kernels drew.
    let web = eframe::WebOptions {
        wgpu_options,
        dithering: false,
        ..Default::default()
    };
    let create = move |cc: &eframe::CreationContext<'_>| -> Result<
        Box<dyn eframe::App>,
        Box<dyn std::error::Error + Send + Sync>,
    > {
        WINDOW.set(Some(cc.egui_ctx.clone()));
        let mut app = App::new(cc, options)?;
        wake_on_loss(cc);
        then(&mut app);
        Ok(Box::new(app))
    };
    let runner = eframe::WebRunner::new();
    RUNNER.set(Some(runner.clone()));
    runner.start(canvas, web, Box::new(create)).await
}

/// A lost device is noticed in the next frame, which nothing else may ask for.
fn wake_on_loss(cc: &eframe::CreationContext<'_>) {
    if let Some(window) = &cc.wgpu_render_state {
        let ctx = cc.egui_ctx.clone();
        let wake = move |_, _| ctx.request_repaint();
        window.device.set_device_lost_callback(wake);
    }
}

thread_local! {
    /// The window of the page.
    static WINDOW: RefCell<Option<egui::Context>> = const { RefCell::new(None) };
    /// What runs it.
    static RUNNER: RefCell<Option<eframe::WebRunner>> = const { RefCell::new(None) };
    /// What it is to do: paths of files in memory that it opens, or why there are none.
    static WAITING: RefCell<Vec<Result<Vec<PathBuf>, String>>> = const { RefCell::new(Vec::new()) };
}

fn wait(next: Result<Vec<PathBuf>, String>) {
    WAITING.with_borrow_mut(|waiting| waiting.push(next));
    WINDOW.with_borrow(|window| window.iter().for_each(egui::Context::request_repaint));
}

/// Has the window open one of these files, which are in memory.
pub fn open_given(paths: Vec<PathBuf>) {
    wait(Ok(paths));
}

/// Has the window show why something that was given to it is not opened.
pub fn refuse(why: String) {
    wait(Err(why));
}

/// Sends what waits to the window.
pub fn send_waiting(commands: &Commands) {
    for waiting in WAITING.take() {
        match waiting {
            Ok(paths) => input::open_given(paths, commands),
            Err(why) => commands.notify(Level::Error, why),
        }
    }
}

fn storage() -> Option<Storage> {
    web_sys::window()?.local_storage().ok()?
}

/// Puts what the browser has kept into memory.
fn read_kept() {
    let Some(storage) = storage() else { return };
    let keys = (0..storage.length().unwrap_or(0)).filter_map(|at| storage.key(at).ok()?);
    for key in keys.filter(|key| Path::new(key).starts_with(KEPT)) {
        if let Ok(Some(text)) = storage.get_item(&key) {
            disk::put(Path::new(&key), text.as_bytes());
        }
    }
}

/// The browser keeps files of [`KEPT`], those of [`UNPACKED`] stay in memory, and all others are
/// downloads.
fn keep(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.starts_with(UNPACKED) {
        return has_room(bytes.len());
    }
    if !path.starts_with(KEPT) {
        return download(path, bytes).map_err(io::Error::other);
    }
    let storage =
        storage().ok_or_else(|| io::Error::other("the browser keeps nothing for this page"))?;
    let text = String::from_utf8_lossy(bytes);
    note_open(path, &text);
    storage
        .set_item(&path.to_string_lossy(), &text)
        .map_err(|_| {
            io::Error::other(
                "the browser's storage for this page is full; File > Export everything saves what is open as a file",
            )
        })
}

/// An error if the files of [`UNPACKED`] would be larger than an archive may be with so many bytes
/// more.
fn has_room(more: usize) -> io::Result<()> {
    let files = disk::below(Path::new(UNPACKED));
    let bytes = more + files.iter().map(|(_, file)| file.len()).sum::<usize>();
    if bytes as u64 > archive::MOST_BYTES {
        let most = archive::MOST_BYTES >> 20;
        let error = format!("all frames have more than {most} MiB; choose a smaller size or fewer");
        return Err(io::Error::other(error));
    }
    Ok(())
}

/// The page has the text of what is open, to be saved after a panic.
fn note_open(path: &Path, text: &str) {
    let session = LastSession::parse(text, "");
    if let Ok(session) = session
        && path.ends_with("session.toml")
    {
        let _ = Reflect::set(
            &js_sys::global(),
            &"rasterlabOpened".into(),
            &session.text().into(),
        );
    }
}

/// Has the browser put a file among its downloads.
///
/// # Errors
/// It refuses: in words.
pub fn download(path: &Path, bytes: &[u8]) -> Result<(), String> {
    try_download(path, bytes).map_err(|_| "the browser refuses a download".into())
}

fn try_download(path: &Path, bytes: &[u8]) -> Result<(), JsValue> {
    let document = web_sys::window().and_then(|window| window.document());
    let document = document.ok_or(JsValue::NULL)?;
    let blob = Blob::new_with_u8_array_sequence(&Array::of1(&Uint8Array::from(bytes)))?;
    let address = Url::create_object_url_with_blob(&blob)?;
    let link: HtmlAnchorElement = document.create_element("a")?.unchecked_into();
    link.set_href(&address);
    link.set_download(&path.file_name().unwrap_or_default().to_string_lossy());
    link.click();
    Url::revoke_object_url(&address)
}

/// Files that a person has given, which lie in memory now.
#[derive(Default)]
pub struct Given {
    pub paths: Vec<PathBuf>,
    /// They are those of an export of everything.
    pub is_export: bool,
}

impl Given {
    /// Puts a file into memory, and the files of an archive in its place.
    ///
    /// # Errors
    /// An archive cannot be read, or the browser does not keep what it has: why, in one sentence.
    fn take(&mut self, name: &Path, bytes: &[u8]) -> Result<(), String> {
        let path = Path::new(GIVEN).join(name.file_name().unwrap_or_default());
        let is_archive = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("zip"));
        if !is_archive {
            disk::put(&path, bytes);
            self.paths.push(path);
            return Ok(());
        }
        let failed = |why: String| format!("{}: {why}", name.display());
        let files = archive::read(bytes).map_err(failed)?;
        if take_along::is_export(&files) {
            self.is_export = true;
            for (inside, bytes) in files {
                let path = Path::new("/").join(inside);
                disk::put(&path, &bytes);
                if path.starts_with(KEPT) {
                    keep(&path, &bytes).map_err(|error| failed(error.to_string()))?;
                }
            }
            return Ok(());
        }
        let folder = path.with_extension("");
        for (inside, bytes) in files {
            let path = folder.join(inside);
            disk::put(&path, &bytes);
            self.paths.push(path);
        }
        Ok(())
    }
}

/// Shows the browser's dialog for files with these extensions and reads what is chosen into memory;
/// nothing if it was canceled.
///
/// # Errors
/// The browser shows none, or a file cannot be read: why, in one sentence.
pub async fn ask_files(extensions: &[&str]) -> Result<Given, String> {
    let failed = |_| "the browser shows no dialog for files".to_owned();
    let document = web_sys::window().and_then(|window| window.document());
    let document = document.ok_or_else(|| failed(JsValue::NULL))?;
    let input: HtmlInputElement = document
        .create_element("input")
        .map_err(failed)?
        .unchecked_into();
    input.set_type("file");
    input.set_multiple(true);
    input.set_accept(
        &extensions
            .iter()
            .map(|e| format!(".{e}"))
            .collect::<Vec<_>>()
            .join(","),
    );
    let ended = Promise::new(&mut |resolve: Function, _: Function| {
        for event in ["change", "cancel"] {
            let resolve = resolve.clone();
            let end = Closure::once_into_js(move || drop(resolve.call0(&JsValue::NULL)));
            // The element is new: it takes any listener.
            let _ = input.add_event_listener_with_callback(event, end.unchecked_ref());
        }
        input.click();
    });
    JsFuture::from(ended).await.map_err(failed)?;
    let mut given = Given::default();
    let chosen = input.files();
    let count = chosen.as_ref().map_or(0, |files| files.length());
    for file in (0..count).filter_map(|at| chosen.as_ref()?.get(at)) {
        let bytes = bytes_of(&file)
            .await
            .map_err(|_| format!("{}: the browser cannot read it", file.name()))?;
        given.take(Path::new(&file.name()), &bytes)?;
    }
    Ok(given)
}

async fn bytes_of(file: &File) -> Result<Vec<u8>, JsValue> {
    let buffer = JsFuture::from(file.array_buffer()).await?;
    Ok(Uint8Array::new(&buffer).to_vec())
}

/// Reads dropped files into memory.
///
/// # Errors
/// One cannot be read: why, in one sentence.
pub async fn take_dropped(files: Vec<egui::DroppedFileHandle>) -> Result<Given, String> {
    let mut given = Given::default();
    for file in files {
        let bytes = file.bytes_async().await?;
        given.take(file.path(), &bytes)?;
    }
    Ok(given)
}

/// The address of the page beside the window.
pub fn beside() -> String {
    let address = web_sys::window().and_then(|window| window.location().href().ok());
    let address = address.unwrap_or_else(|| link::PAGE.into());
    let folder = address
        .split(['?', '#'])
        .next()
        .and_then(|of| of.rsplit_once('/'));
    folder.map_or_else(|| link::PAGE.into(), |(folder, _)| format!("{folder}/"))
}

/// What the page knows under a name, if that is text.
fn known(name: &str) -> Option<String> {
    let found = Reflect::get(&js_sys::global(), &name.into()).ok()?;
    found.as_string().filter(|text| !text.is_empty())
}

/// The name of the graphics device, as far as the browser tells it.
pub fn adapter_name() -> Option<String> {
    known("rasterlabAdapter")
}

/// Tells the page that the window cannot go on: it shows why, with a way to save what is open.
pub fn stop(why: &str) {
    let report = Reflect::get(&js_sys::global(), &"reportError".into());
    if let Ok(report) = report.and_then(|report| report.dyn_into::<Function>()) {
        let _ = report.call1(&JsValue::NULL, &js_sys::Error::new(why));
    }
}

/// Tells the page the title of what is open, and the id where that is a preset of the gallery as it
/// is there: its address says so.
pub fn tell_shown(title: &str, is_modified: bool, open: &PresetFile) {
    let is_of_gallery = open.read_only && open.path.is_none() && !is_modified;
    let id = if is_of_gallery { &open.id } else { "" };
    let told = Reflect::get(&js_sys::global(), &"rasterlabShows".into());
    if let Ok(told) = told.and_then(|told| told.dyn_into::<Function>()) {
        let _ = told.call2(&JsValue::NULL, &title.into(), &id.into());
    }
}

/// Where the golden of a preset of the gallery lies beside the page.
pub fn golden_name(id: &str) -> String {
    format!("goldens/{id}.png")
}

/// The golden of a preset of the gallery, with its width and height.
///
/// # Errors
/// There is none.
pub async fn golden(id: &str) -> Result<(Vec<[u8; 4]>, [u32; 2]), JsValue> {
    let window = web_sys::window().ok_or(JsValue::NULL)?;
    let name = golden_name(id);
    let answer: Response = JsFuture::from(window.fetch_with_str(&name))
        .await?
        .unchecked_into();
    let buffer = JsFuture::from(answer.array_buffer()?).await?;
    let bytes = Uint8Array::new(&buffer).to_vec();
    let golden = preset_file::pixels_of_png(&bytes, &name);
    Ok(golden.map_err(|error| error.to_string())?)
}
