//! The system's file dialog. Some desktops have none: then it says so, and the dialog of the window
//! serves.

use std::path::{Path, PathBuf};

use super::{command::Purpose, desktop_dialog};
use crate::preset_file::MODEL_FORMATS;

/// How the system's dialog ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    Chosen(PathBuf),
    Canceled,
    /// It could not be shown: why.
    Unavailable(String),
}

/// File types that a dialog offers.
pub fn extensions(purpose: Purpose) -> Vec<&'static str> {
    match purpose {
        Purpose::Open => ["toml"]
            .into_iter()
            .chain(MODEL_FORMATS.iter().map(|format| format.extension))
            .chain(["png", "wgsl"])
            .chain(cfg!(target_arch = "wasm32").then_some("zip"))
            .collect(),
        Purpose::SaveAs => vec!["toml"],
        Purpose::Export | Purpose::Sheet => vec!["png"],
    }
}

const fn types_name(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Open => "Presets, models, pictures, effects",
        Purpose::SaveAs => "Presets",
        Purpose::Export | Purpose::Sheet => "Pictures",
    }
}

/// False if it is certain that there is no system's dialog: no desktop to ask, and no `zenity`.
pub fn may_exist() -> bool {
    if cfg!(target_arch = "wasm32") {
        return false;
    }
    if cfg!(not(target_os = "linux")) {
        return true;
    }
    let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let has_bus = variable("DBUS_SESSION_BUS_ADDRESS").is_some()
        || variable("XDG_RUNTIME_DIR")
            .is_some_and(|folder| Path::new(&folder).join("bus").exists());
    has_bus
        || variable("PATH").is_some_and(|path| {
            std::env::split_paths(&path).any(|folder| folder.join("zenity").is_file())
        })
}

/// The dialog, beginning at `start`; what it returns shows it and waits for its end.
pub fn prepare(purpose: Purpose, start: &Path) -> impl AsyncFnOnce() -> Answer + Send + use<> {
    let show = desktop_dialog::prepare(
        types_name(purpose),
        &extensions(purpose),
        start,
        purpose == Purpose::Open,
    );
    async move || match show().await {
        Ok(Some(path)) => Answer::Chosen(path),
        Ok(None) => Answer::Canceled,
        Err(reason) => Answer::Unavailable(reason),
    }
}
