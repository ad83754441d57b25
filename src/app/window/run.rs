//! The window on a desktop: opening it, and opening it again when the graphics device is lost.

use super::{
    app::{App, Options},
    loss::LossFlag,
};
use crate::{
    app::{
        files::recovery::recovery_path,
        settings::{WindowSize, keeper::window_size},
        shell::{
            device::{REFUSED, wgpu_setup},
            log::Level,
        },
    },
    gpu::device::AdapterChoice,
};

/// Smallest size of the window's contents, points.
const MIN_SIZE: [f32; 2] = [900.0, 600.0];

/// Size and settings of the window.
fn native_options(adapter: &AdapterChoice, window: WindowSize) -> eframe::NativeOptions {
    eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("rasterlab")
            .with_app_id("rasterlab")
            .with_inner_size(window.size.map(|side| side.max(1.0)))
            .with_maximized(window.is_maximized)
            .with_min_inner_size(MIN_SIZE)
            .with_drag_and_drop(true),
        wgpu_options: egui_wgpu::WgpuConfiguration {
            wgpu_setup: wgpu_setup(adapter),
            ..Default::default()
        },
        // Dithering would change the bytes that the kernels drew.
        dithering: false,
        ..Default::default()
    }
}

/// Lost devices after which the window is not opened again.
const MAX_LOSSES: u32 = 2;

/// Opens the window and returns when it is closed. If the device is lost, the window closes and
/// opens again on a new device, with the preset as it was.
///
/// # Errors
/// If there is no suitable device or no display, or [`DeviceLost`].
pub fn run(options: Options) -> anyhow::Result<()> {
    let mut options = options;
    let window = options
        .config
        .as_deref()
        .map_or_else(WindowSize::default, window_size);
    for losses in 0..=MAX_LOSSES {
        let loss = LossFlag::default();
        let mut opened = options.clone();
        opened.loss = loss.clone();
        let create = move |cc: &eframe::CreationContext<'_>| -> Result<
            Box<dyn eframe::App>,
            Box<dyn std::error::Error + Send + Sync>,
        > {
            let mut app = App::new(cc, opened)?;
            if losses > 0 {
                app.notify(
                    Level::Warning,
                    "The graphics device was lost. The window was opened again with your preset.",
                );
            }
            Ok(Box::new(app))
        };
        let closed = eframe::run_native(
            "rasterlab",
            native_options(&options.adapter, window),
            Box::new(create),
        );
        if !loss.is_set() {
            let refused = REFUSED.lock().ok().and_then(|mut refused| refused.take());
            if let (Err(_), Some(refused)) = (&closed, refused) {
                return Err(refused.into());
            }
            return closed.map_err(|error| match error {
                eframe::Error::WinitEventLoop(_) | eframe::Error::Winit(_) => {
                    anyhow::anyhow!("{}", without_display())
                }
                error => anyhow::anyhow!("the window could not be opened: {error}"),
            });
        }
        options.opened = None;
        options.open = recovery_path()
            .filter(|path| path.exists())
            .map(|path| path.to_string_lossy().into_owned());
    }
    let recovered = recovery_path().map_or_else(String::new, |path| {
        format!("; the preset is saved in {}", path.display())
    });
    Err(DeviceLost {
        times: MAX_LOSSES + 1,
        recovered,
    }
    .into())
}

/// What is said where there is no display.
fn without_display() -> String {
    let set: Vec<String> = ["DISPLAY", "WAYLAND_DISPLAY"]
        .iter()
        .filter_map(|name| Some(format!("{name}={}", std::env::var(name).ok()?)))
        .collect();
    let why = match set.is_empty() {
        true => "neither DISPLAY nor WAYLAND_DISPLAY is set".to_owned(),
        false => format!("{} cannot be reached", set.join(", ")),
    };
    format!(
        "there is no display to open the window on ({why}); the commands that rasterlab --help lists need none"
    )
}

/// The device of the window was lost again and again (exit status 4 of the command line).
#[derive(Debug, thiserror::Error)]
#[error("the graphics device was lost {times} times, so the window is not opened again{recovered}")]
pub struct DeviceLost {
    times: u32,
    recovered: String,
}
