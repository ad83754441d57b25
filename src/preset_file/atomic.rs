//! Atomic files: written beside their place, then renamed, so that a reader sees the old file or the new one.

use std::{
    fs::{File, Metadata},
    io::{self, Write},
    path::{Path, PathBuf},
    time::Duration,
};

use tempfile::NamedTempFile;

use super::PresetError;

/// How unfinished files are called.
const PREFIX: &str = ".rasterlab-";

/// A file that appears under its name on [`AtomicFile::commit`], and is gone when it is dropped before.
pub struct AtomicFile {
    file: NamedTempFile,
    /// As people call it.
    name: String,
    target: PathBuf,
    /// The file that will be replaced.
    there: Option<Metadata>,
}

impl AtomicFile {
    /// Begins a file that will be called `path`. A link there stays a link.
    ///
    /// # Errors
    /// What is there is read-only, or its folder takes no file.
    pub fn create(path: &Path) -> Result<Self, PresetError> {
        let name = path.display().to_string();
        let failed = |reason: String| PresetError::Write { file: name.clone(), reason };
        // Through a link, so that the link stays one.
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let there = std::fs::metadata(&target).ok();
        if there.as_ref().is_some_and(|m| m.permissions().readonly()) {
            return Err(failed("the file is read-only".into()));
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder(&target)).map_err(|e| failed(e.to_string()))?;
        Ok(Self { file, name, target, there })
    }

    /// The error of a write, with the file's name.
    pub fn failed(&self, error: impl ToString) -> PresetError {
        PresetError::Write { file: self.name.clone(), reason: error.to_string() }
    }

    /// The file itself, for whoever wants to keep it while writing.
    pub fn handle(&self) -> io::Result<File> {
        self.file.as_file().try_clone()
    }

    /// Puts the file, which is on the disk by then, in its place.
    pub fn commit(self) -> Result<(), PresetError> {
        let Self { file, name, target, there } = self;
        let failed = |reason: String| PresetError::Write { file: name, reason };
        let rename = || -> io::Result<()> {
            file.as_file().sync_all()?;
            if let Some(there) = there {
                std::fs::set_permissions(file.path(), there.permissions())?;
            }
            file.persist(&target).map_err(|e| e.error)?;
            Ok(())
        };
        rename().map_err(|e| failed(e.to_string()))
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Removes what killed processes left unfinished beside `path`; whatever changed in the last hour may still be wanted.
pub fn sweep(path: &Path) {
    let is_stale = |file: &Path| -> bool {
        let unfinished = file.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX));
        let changed = File::open(file).and_then(|file| file.metadata()).and_then(|m| m.modified());
        unfinished && changed.is_ok_and(|at| at.elapsed().is_ok_and(|age| age > Duration::from_secs(3600)))
    };
    let files = std::fs::read_dir(folder(path)).into_iter().flatten().flatten().map(|entry| entry.path());
    // A file that stays is a pity and no more.
    files.filter(|file| is_stale(file)).for_each(|file| drop(std::fs::remove_file(file)));
}
