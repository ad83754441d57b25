//! The window in a page.

use eframe::{egui_wgpu, wasm_bindgen::JsValue, web_sys::HtmlCanvasElement};

use super::{
    device::wgpu_setup,
    loss::LossFlag,
    window::{App, Options},
};

/// Shows the window on a canvas. What works in threads of its own, as drawing the picture, loading
/// models and judging do, reports there that none could be started.
///
/// # Errors
/// If the browser has no WebGPU.
pub async fn start(canvas: HtmlCanvasElement, options: Options) -> Result<(), JsValue> {
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
        Ok(Box::new(App::with_loss_flag(
            cc,
            options,
            LossFlag::default(),
        )?))
    };
    eframe::WebRunner::new()
        .start(canvas, web, Box::new(create))
        .await
}
