//! rasterlab's window in a web page: the program's own, on a canvas of the page.

#![cfg(target_arch = "wasm32")]

use std::path::{Path, PathBuf};

use js_sys::Array;
use rasterlab::{
    app::{self, Options},
    host::disk,
    preset_file,
};
use wasm_bindgen::prelude::{JsError, JsValue, wasm_bindgen};
use web_sys::HtmlCanvasElement;

/// The words and place of a panic go to the console, and to `rasterlabPanic` of the page, which shows
/// them with a way to save what is open.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| {
        web_sys::console::error_1(&js_sys::Error::new(&panic.to_string()));
        let (place, name) = (js_sys::global(), "rasterlabPanic");
        let _ = js_sys::Reflect::set(&place, &name.into(), &panic.to_string().into());
    }));
}

/// Does a task of the window in a worker, which has an instance of the module for itself: see
/// `rasterlab::app::answer`.
///
/// # Errors
/// It cannot be done: why, in one sentence.
#[wasm_bindgen]
pub async fn answer(
    task: u32,
    text: String,
    width: u32,
    height: u32,
    files: Option<Array>,
    axes: Option<String>,
) -> Result<JsValue, JsError> {
    let axes = axes.unwrap_or_default();
    let answered = app::answer(task, &text, [width, height], files, &axes).await;
    answered.map_err(|error| JsError::new(&error))
}

/// Has the measurement under way in this worker wait for so many milliseconds, or end with what it
/// has.
#[wasm_bindgen]
pub fn heed(pause_ms: Option<f64>) {
    app::heed(pause_ms);
}

/// Puts a file where the window looks for files that it was given.
#[wasm_bindgen]
pub fn give_file(path: &str, bytes: &[u8]) {
    disk::put(Path::new(path), bytes);
}

/// Has the open window open one of the files at these paths, which [`give_file`] has put there.
#[wasm_bindgen]
pub fn open_given(paths: Vec<String>) {
    app::open_given(paths.into_iter().map(PathBuf::from).collect());
}

/// Has the open window show why something that was given to it is not opened.
#[wasm_bindgen]
pub fn refuse(why: String) {
    app::refuse(why);
}

/// Opens the window on a canvas. `open` is what it begins with: the id of a preset of the gallery,
/// the path of a file that [`give_file`] has put there, or the line that the window copies. Then it
/// opens the file `model`.
///
/// # Errors
/// If the browser has no WebGPU, or the line cannot be read.
#[wasm_bindgen]
pub async fn open_window(
    canvas: HtmlCanvasElement,
    open: Option<String>,
    model: Option<String>,
) -> Result<(), JsValue> {
    let is_line = |open: &String| open.starts_with("rasterlab1:");
    let options = match open.clone().filter(is_line) {
        Some(line) => Options {
            opened: Some(preset_file::from_line(&line).map_err(|error| error.to_string())?),
            ..Options::default()
        },
        None => Options {
            open,
            ..Options::default()
        },
    };
    app::start(canvas, options, model.map(PathBuf::from)).await
}

/// Opens the window again on another canvas, after its device was lost: with the files that it had
/// and what was open.
///
/// # Errors
/// If the browser gives no device any more.
#[wasm_bindgen]
pub async fn reopen_window(canvas: HtmlCanvasElement) -> Result<(), JsValue> {
    app::reopen(canvas).await
}
