//! Atomic files: written next to their target, then renamed, so that a reader sees the old file or
//! the new one.

use std::{
    collections::HashSet,
    ffi::OsStr,
    fs::{File, Metadata, OpenOptions, TryLockError},
    io::{self, Write},
    path::{Path, PathBuf},
    sync::Mutex,
    time::Duration,
};

use tempfile::NamedTempFile;

use super::error::PresetError;

/// The names of unfinished files: prefix, random letters and digits, suffix.
const PREFIX: &str = ".rasterlab-";
const RANDOM: usize = 12;
const SUFFIX: &str = ".tmp";

/// An unfinished file that no process has locked is removed at this age. A younger one may be about
/// to be locked.
const UNLOCKED_STALE: Duration = Duration::from_secs(60);

/// Where the file system has no locks, an unfinished file that did not change for this long is
/// removed.
const UNCHANGED_STALE: Duration = Duration::from_secs(3600);

/// Links that are followed to a file; as many as Linux follows.
const MAX_LINKS: usize = 40;

/// What happens to a file that exists under the name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It stays, and the new file is refused with [`PresetError::Exists`], even if it appeared a
    /// moment ago.
    Keep,
    Replace,
}

/// A file that appears under its name on [`AtomicFile::commit`], and is removed when it is dropped
/// before.
pub struct AtomicFile {
    /// Locked while it is written, so that no other process removes it.
    file: NamedTempFile,
    /// The path for error messages.
    name: String,
    target: PathBuf,
    existing: Existing,
    /// The file that will be replaced.
    replaced: Option<Metadata>,
}

impl AtomicFile {
    /// Begins a file that will be called `path`. A symbolic link stays one: the file that it leads
    /// to is written.
    ///
    /// # Errors
    /// A file is there and `existing` keeps it; it is read-only, or a folder, device or pipe; or
    /// its folder cannot be written.
    pub fn create(path: &Path, existing: Existing) -> Result<Self, PresetError> {
        let name = path.display().to_string();
        let failed = |reason: String| PresetError::Write {
            file: name.clone(),
            reason,
        };
        if existing == Existing::Keep && is_taken(path) {
            return Err(PresetError::Exists { file: name });
        }
        let target = link_target(path).map_err(|e| failed(e.to_string()))?;
        let replaced = std::fs::metadata(&target).ok();
        if let Some(replaced) = &replaced {
            if !replaced.is_file() {
                let kind = if replaced.is_dir() {
                    "is a folder"
                } else {
                    "is a device, pipe or socket"
                };
                return Err(failed(format!(
                    "it {kind}, not a regular file; name another file"
                )));
            }
            if replaced.permissions().readonly() {
                return Err(failed("the file is read-only".into()));
            }
        }
        let folder = folder(&target);
        remove_unfinished(folder);
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).rand_bytes(RANDOM).suffix(SUFFIX);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let file = builder.tempfile_in(folder).map_err(|e| {
            failed(match e.kind() {
                _ if !folder.is_dir() => format!("there is no folder {}", folder.display()),
                io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                    format!("files cannot be made in the folder {}", folder.display())
                }
                _ => e.to_string(),
            })
        })?;
        // A file system without locks is covered by the longer age.
        drop(file.as_file().try_lock());
        Ok(Self {
            file,
            name,
            target,
            existing,
            replaced,
        })
    }

    /// The error of a write, with the file's name.
    pub fn failed(&self, error: impl ToString) -> PresetError {
        PresetError::Write {
            file: self.name.clone(),
            reason: error.to_string(),
        }
    }

    /// Where the file is while it is written, for another program that writes it.
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// A second handle to the file, for a writer that owns one.
    pub fn handle(&self) -> io::Result<File> {
        self.file.as_file().try_clone()
    }

    /// Flushes the file to the disk and renames it to its target.
    ///
    /// # Errors
    /// The disk is full, the target cannot be replaced, or a file that is kept appeared there; then
    /// the target is unchanged.
    pub fn commit(self) -> Result<(), PresetError> {
        let Self {
            file,
            name,
            target,
            existing,
            replaced,
        } = self;
        let rename = || -> io::Result<()> {
            file.as_file().sync_all()?;
            if let Some(replaced) = replaced {
                std::fs::set_permissions(file.path(), replaced.permissions())?;
            }
            match existing {
                Existing::Replace => file.persist(&target).map(drop).map_err(|e| e.error),
                Existing::Keep => persist_new(file, &target),
            }
        };
        rename().map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists if existing == Existing::Keep => {
                PresetError::Exists { file: name }
            }
            _ => PresetError::Write {
                file: name,
                reason: error.to_string(),
            },
        })
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
pub fn write_atomically(path: &Path, bytes: &[u8], existing: Existing) -> Result<(), PresetError> {
    #[cfg(target_arch = "wasm32")]
    {
        let _ = existing;
        return crate::host::disk::write(path, bytes).map_err(|error| PresetError::Write {
            file: path.display().to_string(),
            reason: error.to_string(),
        });
    }
    #[cfg(not(target_arch = "wasm32"))]
    write_beside(path, bytes, existing)
}

#[cfg(not(target_arch = "wasm32"))]
fn write_beside(path: &Path, bytes: &[u8], existing: Existing) -> Result<(), PresetError> {
    let mut file = AtomicFile::create(path, existing)?;
    file.write_all(bytes).map_err(|e| file.failed(e))?;
    file.commit()
}

/// Is there a file or anything else under this name? A symbolic link takes its name, even if it
/// leads nowhere.
pub fn is_taken(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

/// Gives the file its name unless the name is taken, in one step.
fn persist_new(file: NamedTempFile, target: &Path) -> io::Result<()> {
    let Err(failed) = file.persist_noclobber(target) else {
        return Ok(());
    };
    if failed.error.kind() == io::ErrorKind::AlreadyExists {
        return Err(failed.error);
    }
    // File systems without hard links, such as FAT and some network shares: an empty file reserves
    // the name.
    OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(target)?;
    failed.file.persist(target).map(drop).map_err(|e| {
        drop(std::fs::remove_file(target));
        e.error
    })
}

/// The file that `path` leads to through symbolic links; it need not exist.
fn link_target(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        match target.symlink_metadata() {
            Ok(about) if about.is_symlink() => {
                target = folder(&target).join(std::fs::read_link(&target)?)
            }
            _ => return Ok(target),
        }
    }
    Err(io::Error::other("its symbolic links lead in a circle"))
}

fn folder(path: &Path) -> &Path {
    path.parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// Removes unfinished files of killed processes in `folder`; once for each folder in the life of
/// this process.
fn remove_unfinished(folder: &Path) {
    static SEEN: Mutex<Option<HashSet<PathBuf>>> = Mutex::new(None);
    let Ok(mut seen) = SEEN.lock() else { return };
    if !seen.get_or_insert_default().insert(folder.to_owned()) {
        return;
    }
    drop(seen);
    // Names and kinds are looked at first: opening a pipe would wait for its other end.
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let unfinished = files.filter(|file| {
        is_unfinished(&file.file_name()) && file.file_type().is_ok_and(|kind| kind.is_file())
    });
    // A file that cannot be removed does no harm.
    unfinished
        .map(|file| file.path())
        .filter(|file| is_stale(file))
        .for_each(|file| drop(std::fs::remove_file(file)));
}

/// Is this the name of an unfinished file?
fn is_unfinished(name: &OsStr) -> bool {
    let random = name
        .to_str()
        .and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX));
    random.is_some_and(|random| {
        random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
    })
}

/// Does no process write this unfinished file any more?
fn is_stale(path: &Path) -> bool {
    let Ok(file) = OpenOptions::new().read(true).write(true).open(path) else {
        return false;
    };
    let age = file
        .metadata()
        .and_then(|about| about.modified())
        .ok()
        .and_then(|at| at.elapsed().ok())
        .unwrap_or_default();
    match file.try_lock() {
        Ok(()) => age > UNLOCKED_STALE,
        Err(TryLockError::WouldBlock) => false,
        Err(TryLockError::Error(_)) => age > UNCHANGED_STALE,
    }
}
