//! rasterlab's window in a web page: the program's own, on a canvas of the page.

#![cfg(target_arch = "wasm32")]

use rasterlab::{
    app::{self, Options},
    preset_file,
};
use wasm_bindgen::prelude::{JsValue, wasm_bindgen};
use web_sys::HtmlCanvasElement;

/// Panics name their words and place on the console.
#[wasm_bindgen(start)]
pub fn start() {
    console_error_panic_hook::set_once();
}

/// Opens the window on a canvas. `open` is what it begins with: the id of a preset of the gallery,
/// or the line that the window copies.
///
/// # Errors
/// If the browser has no WebGPU, or the line cannot be read.
#[wasm_bindgen]
pub async fn open_window(canvas: HtmlCanvasElement, open: Option<String>) -> Result<(), JsValue> {
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
    app::start(canvas, options).await
}
