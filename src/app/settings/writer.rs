//! Writing small files on a thread of its own, in order. Of several texts for the same file that wait, only the newest is written.

use std::{
    path::{Path, PathBuf},
    sync::mpsc,
    thread::JoinHandle,
};

use crate::preset_file::{Existing, write_atomically};

/// Writes files on a thread of its own. What waits is written before it is dropped.
pub struct Writer {
    sender: Option<mpsc::Sender<(PathBuf, String)>>,
    errors: mpsc::Receiver<String>,
    thread: Option<JoinHandle<()>>,
}

impl Writer {
    /// # Errors
    /// No thread can be started.
    pub fn start() -> std::io::Result<Self> {
        let (sender, texts) = mpsc::channel::<(PathBuf, String)>();
        let (failed, errors) = mpsc::channel();
        let work = move || {
            while let Ok(first) = texts.recv() {
                let mut waiting = vec![first];
                waiting.extend(texts.try_iter());
                for (at, (path, text)) in waiting.iter().enumerate() {
                    let is_newest = waiting[at + 1..].iter().all(|(later, _)| later != path);
                    if is_newest && let Err(error) = write(path, text) {
                        // The window may be closed by now.
                        let _ = failed.send(error);
                    }
                }
            }
        };
        let thread = std::thread::Builder::new().name("settings".into()).spawn(work)?;
        Ok(Self { sender: Some(sender), errors, thread: Some(thread) })
    }

    /// Writes `text` to `path` soon.
    pub fn write(&self, path: PathBuf, text: String) {
        if let Some(sender) = &self.sender {
            // The thread lives as long as `self`.
            let _ = sender.send((path, text));
        }
    }

    /// The next error since the last call.
    pub fn error(&self) -> Option<String> {
        self.errors.try_recv().ok()
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take() {
            // A panic of the thread was printed by it.
            let _ = thread.join();
        }
    }
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: the folder cannot be created: {error}", folder.display()))?;
    write_atomically(path, text.as_bytes(), Existing::Replace).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_text_is_in_the_file_when_the_writer_is_dropped() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("new/settings.toml");
        let writer = Writer::start().expect("a thread");
        (0..50).for_each(|i| writer.write(path.clone(), i.to_string()));
        drop(writer);
        assert_eq!(std::fs::read_to_string(&path).expect("a file"), "49");
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_one_sentence() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("file");
        std::fs::write(&file, "").expect("a file");
        let writer = Writer::start().expect("a thread");
        writer.write(file.join("settings.toml"), String::new());
        let patience = web_time::Instant::now() + std::time::Duration::from_secs(30);
        let error = loop {
            if let Some(error) = writer.error() {
                break error;
            }
            assert!(web_time::Instant::now() < patience, "no error arrived");
            std::thread::yield_now();
        };
        assert!(error.contains("the folder cannot be created"), "{error}");
    }
}
