//! The system's watches on folders. A page has none.

#[cfg(not(target_arch = "wasm32"))]
pub use native::SystemWatch;
#[cfg(target_arch = "wasm32")]
pub use page::SystemWatch;

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::path::{Path, PathBuf};

    use notify::{RecommendedWatcher, RecursiveMode, Watcher as _};

    /// What the system watches.
    pub struct SystemWatch(RecommendedWatcher);

    impl SystemWatch {
        /// None where the system has no watches. `changed` is told which paths have changed, or
        /// none where that is not known.
        pub fn new(changed: impl Fn(Option<&[PathBuf]>) + Send + 'static) -> Option<Self> {
            let watcher = notify::recommended_watcher(
                move |event: notify::Result<notify::Event>| match event {
                    // Reading a file is an event, too, and would never end.
                    Ok(event) if event.kind.is_access() => {}
                    Ok(event) => changed(Some(&event.paths)),
                    Err(_) => changed(None),
                },
            );
            watcher.ok().map(Self)
        }

        /// Watches a folder, with those inside it or alone; true if it can.
        pub fn watch(&mut self, folder: &Path, is_deep: bool) -> bool {
            let mode = if is_deep {
                RecursiveMode::Recursive
            } else {
                RecursiveMode::NonRecursive
            };
            self.0.watch(folder, mode).is_ok()
        }

        /// Watches a folder no longer. It may be gone.
        pub fn unwatch(&mut self, folder: &Path) {
            let _ = self.0.unwatch(folder);
        }
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use std::path::{Path, PathBuf};

    /// There is none.
    pub enum SystemWatch {}

    impl SystemWatch {
        pub fn new(_: impl Fn(Option<&[PathBuf]>) + Send + 'static) -> Option<Self> {
            None
        }

        pub fn watch(&mut self, _: &Path, _: bool) -> bool {
            match *self {}
        }

        pub fn unwatch(&mut self, _: &Path) {
            match *self {}
        }
    }
}
