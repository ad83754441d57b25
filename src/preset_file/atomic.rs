//! Atomic files: written next to their target, then renamed, so that a reader sees the old file or the new one.

use std::{
    fs::{File, Metadata},
    io::{self, Write},
    path::{Path, PathBuf},
    time::Duration,
};

use tempfile::NamedTempFile;

use super::error::PresetError;

/// Prefix of the names of unfinished files.
const PREFIX: &str = ".rasterlab-";

/// A file that appears under its name on [`AtomicFile::commit`], and is removed when it is dropped before.
pub struct AtomicFile {
    file: NamedTempFile,
    /// The path for error messages.
    name: String,
    target: PathBuf,
    /// The file that will be replaced.
    replaced: Option<Metadata>,
}

impl AtomicFile {
    /// Begins a file that will be called `path`. An existing link stays a link.
    ///
    /// # Errors
    /// The existing file is read-only, or its folder cannot be written.
    pub fn create(path: &Path) -> Result<Self, PresetError> {
        let name = path.display().to_string();
        let failed = |reason: String| PresetError::Write { file: name.clone(), reason };
        // Through a link, so that the link stays one.
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let replaced = std::fs::metadata(&target).ok();
        if replaced.as_ref().is_some_and(|m| m.permissions().readonly()) {
            return Err(failed("the file is read-only".into()));
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder(&target)).map_err(|e| failed(e.to_string()))?;
        Ok(Self { file, name, target, replaced })
    }

    /// The error of a write, with the file's name.
    pub fn failed(&self, error: impl ToString) -> PresetError {
        PresetError::Write { file: self.name.clone(), reason: error.to_string() }
    }

    /// A second handle to the file, for a writer that owns one.
    pub fn handle(&self) -> io::Result<File> {
        self.file.as_file().try_clone()
    }

    /// Flushes the file to the disk and renames it to its target.
    ///
    /// # Errors
    /// The disk is full or the target cannot be replaced; then the target is unchanged.
    pub fn commit(self) -> Result<(), PresetError> {
        let Self { file, name, target, replaced } = self;
        let failed = |reason: String| PresetError::Write { file: name, reason };
        let rename = || -> io::Result<()> {
            file.as_file().sync_all()?;
            if let Some(replaced) = replaced {
                std::fs::set_permissions(file.path(), replaced.permissions())?;
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

/// Writes `bytes` next to `path`, then renames, so that a reader sees the old file or the new one.
///
/// # Errors
/// As [`AtomicFile::create`] and [`AtomicFile::commit`].
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), PresetError> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes).map_err(|e| file.failed(e))?;
    file.commit()
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Removes unfinished files of killed processes in the folder of `path`. A file that changed in the last hour may belong to a
/// running process and stays.
pub fn remove_unfinished(path: &Path) {
    let is_stale = |file: &Path| -> bool {
        let unfinished = file.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX));
        let changed = File::open(file).and_then(|file| file.metadata()).and_then(|m| m.modified());
        unfinished && changed.is_ok_and(|at| at.elapsed().is_ok_and(|age| age > Duration::from_secs(3600)))
    };
    let files = std::fs::read_dir(folder(path)).into_iter().flatten().flatten().map(|entry| entry.path());
    // A file that cannot be removed does no harm.
    files.filter(|file| is_stale(file)).for_each(|file| drop(std::fs::remove_file(file)));
}
