//! The window in a page: opening it, the files that a person gives to it and takes from it, and what
//! the browser keeps for it.

use std::{
    io,
    path::{Path, PathBuf},
};

use eframe::{egui, egui_wgpu, web_sys::HtmlCanvasElement};
use js_sys::{Array, Function, Promise, Uint8Array};
use wasm_bindgen::{JsCast as _, JsValue, prelude::Closure};
use wasm_bindgen_futures::JsFuture;
use web_sys::{Blob, File, HtmlAnchorElement, HtmlInputElement, Response, Storage, Url};

use super::{
    device::wgpu_setup,
    loss::LossFlag,
    window::{App, Options},
};
use crate::{host::disk, preset_file};

/// The folder whose files the browser keeps: settings and session.
const KEPT: &str = "/rasterlab";

/// The folder of files that a person has given.
const GIVEN: &str = "/given";

/// Shows the window on a canvas. The browser keeps its settings and its session.
///
/// # Errors
/// If the browser has no WebGPU.
pub async fn start(canvas: HtmlCanvasElement, options: Options) -> Result<(), JsValue> {
    disk::keep_with(keep);
    read_kept();
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
        let app = App::with_loss_flag(cc, options, LossFlag::default())?;
        Ok(Box::new(app))
    };
    eframe::WebRunner::new()
        .start(canvas, web, Box::new(create))
        .await
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

/// The browser keeps files of [`KEPT`], and all others are downloads.
fn keep(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if !path.starts_with(KEPT) {
        return download(path, bytes)
            .map_err(|_| io::Error::other("the browser refuses a download"));
    }
    let storage =
        storage().ok_or_else(|| io::Error::other("the browser keeps nothing for this page"))?;
    let text = String::from_utf8_lossy(bytes);
    storage
        .set_item(&path.to_string_lossy(), &text)
        .map_err(|_| io::Error::other("the browser's storage for this page is full"))
}

fn download(path: &Path, bytes: &[u8]) -> Result<(), JsValue> {
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

/// Shows the browser's dialog for files with these extensions and reads what is chosen into memory.
/// Returns their paths; none if it was canceled.
///
/// # Errors
/// The browser shows none, or a file cannot be read: why, in one sentence.
pub async fn ask_files(extensions: &[&str]) -> Result<Vec<PathBuf>, String> {
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
    let mut paths = Vec::new();
    let chosen = input.files();
    let count = chosen.as_ref().map_or(0, |files| files.length());
    for file in (0..count).filter_map(|at| chosen.as_ref()?.get(at)) {
        let bytes = bytes_of(&file)
            .await
            .map_err(|_| format!("{}: the browser cannot read it", file.name()))?;
        paths.push(given(Path::new(&file.name()), &bytes));
    }
    Ok(paths)
}

async fn bytes_of(file: &File) -> Result<Vec<u8>, JsValue> {
    let buffer = JsFuture::from(file.array_buffer()).await?;
    Ok(Uint8Array::new(&buffer).to_vec())
}

/// Reads dropped files into memory. Returns their paths.
///
/// # Errors
/// One cannot be read: why, in one sentence.
pub async fn take_dropped(files: Vec<egui::DroppedFileHandle>) -> Result<Vec<PathBuf>, String> {
    let mut paths = Vec::new();
    for file in files {
        let bytes = file.bytes_async().await?;
        paths.push(given(file.path(), &bytes));
    }
    Ok(paths)
}

/// The golden of a preset of the gallery, which lies beside the page.
///
/// # Errors
/// There is none.
pub async fn golden(id: &str) -> Result<egui::ColorImage, JsValue> {
    let window = web_sys::window().ok_or(JsValue::NULL)?;
    let name = format!("goldens/{id}.png");
    let answer: Response = JsFuture::from(window.fetch_with_str(&name))
        .await?
        .unchecked_into();
    let buffer = JsFuture::from(answer.array_buffer()?).await?;
    let bytes = Uint8Array::new(&buffer).to_vec();
    let (colors, size) =
        preset_file::pixels_of_png(&bytes, &name).map_err(|error| error.to_string())?;
    Ok(egui::ColorImage::from_rgba_unmultiplied(
        size.map(|side| side as usize),
        colors.as_flattened(),
    ))
}

/// Puts a file that a person has given into memory, and returns its path there.
fn given(name: &Path, bytes: &[u8]) -> PathBuf {
    let path = Path::new(GIVEN).join(name.file_name().unwrap_or_default());
    disk::put(&path, bytes);
    path
}
