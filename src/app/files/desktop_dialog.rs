//! The file dialog of a desktop, through the library `rfd`. A page has none that gives paths.

#[cfg(not(target_arch = "wasm32"))]
pub use native::prepare;
#[cfg(target_arch = "wasm32")]
pub use page::prepare;

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::{
        path::{Path, PathBuf},
        pin::Pin,
        sync::{Mutex, OnceLock, PoisonError},
    };

    /// A dialog for files with these extensions, beginning at `start`. What it returns shows it,
    /// waits for its end, and gives the path that was chosen, or why no dialog could be shown.
    pub fn prepare(
        types_name: &str,
        extensions: &[&str],
        start: &Path,
        is_to_open: bool,
    ) -> impl AsyncFnOnce() -> Result<Option<PathBuf>, String> + Send + use<> {
        let mut dialog = rfd::AsyncFileDialog::new().add_filter(types_name, extensions);
        if let Some(folder) = start.parent().filter(|folder| folder.is_dir()) {
            dialog = dialog.set_directory(folder);
        }
        let name = start
            .file_name()
            .map(|name| name.to_string_lossy().into_owned())
            .unwrap_or_default();
        let chosen: Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match is_to_open
        {
            true => Box::pin(dialog.pick_file()),
            false => Box::pin(dialog.set_file_name(name).save_file()),
        };
        let listens = listen();
        async move || {
            let chosen = chosen.await.map(|file| file.path().to_owned());
            outcome(chosen, if listens { take_failures() } else { Vec::new() })
        }
    }

    /// What the dialog's end means. Without a portal the `rfd` library tries `zenity`; only if that
    /// fails, too, no dialog was shown.
    fn outcome(chosen: Option<PathBuf>, failures: Vec<String>) -> Result<Option<PathBuf>, String> {
        if chosen.is_none() && failures.iter().any(|failure| failure.contains("zenity")) {
            let reason = failures.into_iter().next().unwrap_or_default();
            return Err(reason.lines().next().unwrap_or_default().to_owned());
        }
        Ok(chosen)
    }

    /// `rfd` gives no path both when the user cancels and when no dialog can be shown; why is only
    /// in what it logs.
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
        *LISTENS.get_or_init(|| {
            log::set_logger(&FAILURES)
                .map(|()| log::set_max_level(log::LevelFilter::Error))
                .is_ok()
        })
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
            assert_eq!(
                outcome(Some("a.glb".into()), vec![portal.clone()]),
                Ok(Some("a.glb".into()))
            );
            assert_eq!(outcome(None, vec![]), Ok(None));
            assert_eq!(
                outcome(None, vec![portal.clone()]),
                Ok(None),
                "zenity was shown and canceled"
            );
            assert_eq!(outcome(None, vec![portal.clone(), zenity]), Err(portal));
        }
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use std::path::{Path, PathBuf};

    pub fn prepare(
        _: &str,
        _: &[&str],
        _: &Path,
        _: bool,
    ) -> impl AsyncFnOnce() -> Result<Option<PathBuf>, String> + Send + use<> {
        async || Err("a page has no folders".into())
    }
}
