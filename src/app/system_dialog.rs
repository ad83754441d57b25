//! The system's file dialog. Some desktops have none: then it says so, and the dialog of the window serves.

use std::{
    path::{Path, PathBuf},
    sync::{Mutex, OnceLock, PoisonError},
};

use super::command::Purpose;
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
        Purpose::Open => ["toml"].into_iter().chain(MODEL_FORMATS.iter().map(|format| format.extension)).chain(["png", "wgsl"]).collect(),
        Purpose::SaveAs => vec!["toml"],
        Purpose::Export => vec!["png"],
    }
}

const fn types_name(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Open => "Presets, models, pictures, effects",
        Purpose::SaveAs => "Presets",
        Purpose::Export => "Pictures",
    }
}

/// False if it is certain that there is no system's dialog: no desktop to ask, and no `zenity`.
pub fn may_exist() -> bool {
    if cfg!(not(target_os = "linux")) {
        return true;
    }
    let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let has_bus = variable("DBUS_SESSION_BUS_ADDRESS").is_some()
        || variable("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
    has_bus || variable("PATH").is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join("zenity").is_file()))
}

/// The dialog, beginning at `start`; what it returns shows it and waits for its end.
pub fn prepare(purpose: Purpose, start: &Path) -> impl FnOnce() -> Answer + Send + 'static {
    let mut dialog = rfd::AsyncFileDialog::new().add_filter(types_name(purpose), &extensions(purpose));
    if let Some(folder) = start.parent().filter(|folder| folder.is_dir()) {
        dialog = dialog.set_directory(folder);
    }
    let name = start.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let chosen: std::pin::Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match purpose {
        Purpose::Open => Box::pin(dialog.pick_file()),
        Purpose::SaveAs | Purpose::Export => Box::pin(dialog.set_file_name(name).save_file()),
    };
    let listens = listen();
    move || {
        let chosen = pollster::block_on(chosen).map(|file| file.path().to_owned());
        answer(chosen, if listens { take_failures() } else { Vec::new() })
    }
}

/// What the dialog's end means. Without a portal the `rfd` library tries `zenity`; only if that fails, too, no dialog was shown.
fn answer(chosen: Option<PathBuf>, failures: Vec<String>) -> Answer {
    match chosen {
        Some(path) => Answer::Chosen(path),
        None if failures.iter().any(|failure| failure.contains("zenity")) => {
            let reason = failures.into_iter().next().unwrap_or_default();
            Answer::Unavailable(reason.lines().next().unwrap_or_default().to_owned())
        }
        None => Answer::Canceled,
    }
}

/// `rfd` gives no path both when the user cancels and when no dialog can be shown; why is only in what it logs.
struct Failures(Mutex<Vec<String>>);

static FAILURES: Failures = Failures(Mutex::new(Vec::new()));

/// Failures that are kept; a dialog logs two.
const MAX_FAILURES: usize = 8;

impl log::Log for Failures {
    fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
        metadata.level() == log::Level::Error && metadata.target().starts_with("rfd")
    }

    fn log(&self, record: &log::Record<'_>) {
        if self.enabled(record.metadata()) {
            let mut failures = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            failures.push(record.args().to_string());
            failures.truncate(MAX_FAILURES);
        }
    }

    fn flush(&self) {}
}

/// Listens to what `rfd` logs. False if another logger is installed.
fn listen() -> bool {
    static LISTENS: OnceLock<bool> = OnceLock::new();
    take_failures();
    *LISTENS.get_or_init(|| log::set_logger(&FAILURES).map(|()| log::set_max_level(log::LevelFilter::Error)).is_ok())
}

fn take_failures() -> Vec<String> {
    std::mem::take(&mut *FAILURES.0.lock().unwrap_or_else(PoisonError::into_inner))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_dialog_that_could_not_be_shown_is_unavailable() {
        let portal = "Failed to connect to session bus: not found".to_owned();
        let zenity = "Failed to pick file with zenity: No such file or directory".to_owned();
        assert_eq!(answer(Some("a.glb".into()), vec![portal.clone()]), Answer::Chosen("a.glb".into()));
        assert_eq!(answer(None, vec![]), Answer::Canceled);
        assert_eq!(answer(None, vec![portal.clone()]), Answer::Canceled, "zenity was shown and canceled");
        assert_eq!(answer(None, vec![portal.clone(), zenity]), Answer::Unavailable(portal));
    }
}
