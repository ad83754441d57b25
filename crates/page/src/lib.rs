//! rasterlab in a web page. [`Page`] draws presets on the page's device; [`OraclePicture`] is the
//! oracle's, drawn in a worker, which has an instance of the module for itself. Both take the text
//! of a preset and give plain arrays, so that the page needs no other library.

#![cfg(target_arch = "wasm32")]

mod open_preset;
mod page;

use wasm_bindgen::prelude::wasm_bindgen;

pub use open_preset::{OpenPreset, OraclePicture, oracle_picture};
pub use page::{Page, Picture};

/// Panics name their words and place on the console.
#[wasm_bindgen(start)]
pub fn start() {
    console_error_panic_hook::set_once();
}
