//! rasterlab in a web page. [`Page`] draws presets on the page's device and reads them back, [`Live`]
//! shows them on a canvas. [`oracle_rows`] draws rows of the oracle's picture in a worker, which has an
//! instance of the module for itself. All take an [`OpenPreset`].

#![cfg(target_arch = "wasm32")]

mod live;
mod open_preset;
mod page;

use wasm_bindgen::prelude::wasm_bindgen;

pub use live::Live;
pub use open_preset::{OpenPreset, can_share_rows, oracle_bits, oracle_rows};
pub use page::{Judged, Page, Picture};

/// The words and place of a panic go to the console, and to `rasterlabPanic` of the page, which shows
/// them.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| {
        web_sys::console::error_1(&js_sys::Error::new(&panic.to_string()));
        let _ = js_sys::Reflect::set(
            &js_sys::global(),
            &"rasterlabPanic".into(),
            &panic.to_string().into(),
        );
    }));
}
