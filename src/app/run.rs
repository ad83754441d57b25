//! Opening the window, and opening it again when the graphics device is lost.

use anyhow::Context as _;

use super::{
    device::native_options,
    log::Level,
    loss::LossFlag,
    recovery::recovery_path,
    settings::{WindowPlace, keeper::window_place},
    window::{App, Options},
};

/// Lost devices after which the window is not opened again.
const MAX_LOSSES: u32 = 2;

/// Opens the window and returns when it is closed. If the device is lost, the window closes and opens again on a new device,
/// with the preset as it was.
///
/// # Errors
/// If there is no suitable device or no display, or [`DeviceLost`].
pub fn run(options: Options) -> anyhow::Result<()> {
    let mut options = options;
    let window = options.config.as_deref().map_or_else(WindowPlace::default, window_place);
    for losses in 0..=MAX_LOSSES {
        let loss = LossFlag::default();
        let (flag, opened) = (loss.clone(), options.clone());
        let create = move |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, Box<dyn std::error::Error + Send + Sync>> {
            let mut app = App::with_loss_flag(cc, opened, flag)?;
            if losses > 0 {
                app.notify(Level::Warning, "The graphics device was lost. The window was opened again with your preset.");
            }
            Ok(Box::new(app))
        };
        let closed = eframe::run_native("rasterlab", native_options(&options.adapter, window), Box::new(create));
        if !loss.is_set() {
            return closed.map_err(|error| anyhow::anyhow!("{error}")).context("the window could not be opened");
        }
        options.opened = None;
        options.open = recovery_path().filter(|path| path.exists()).map(|path| path.to_string_lossy().into_owned());
    }
    let recovered = recovery_path().map_or_else(String::new, |path| format!("; the preset is saved in {}", path.display()));
    Err(DeviceLost { times: MAX_LOSSES + 1, recovered }.into())
}

/// The device of the window was lost again and again (exit status 4 of the command line).
#[derive(Debug, thiserror::Error)]
#[error("the graphics device was lost {times} times, so the window is not opened again{recovered}")]
pub struct DeviceLost {
    times: u32,
    recovered: String,
}
