//! A file that a page writes: it lies in memory until it is finished.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use super::{atomic::Existing, error::PresetError};
use crate::{archive::MOST_BYTES, host::disk};

/// A file that appears under its name on [`InMemory::commit`]. All handles write to the same bytes,
/// of which there are at most [`MOST_BYTES`].
#[derive(Clone)]
pub struct InMemory {
    path: PathBuf,
    bytes: Arc<Mutex<Vec<u8>>>,
}

impl InMemory {
    /// Begins a file that will be called `path`. A page replaces nothing: what it writes is a
    /// download.
    pub fn create(path: &Path, _: Existing) -> Result<Self, PresetError> {
        Ok(Self {
            path: path.to_owned(),
            bytes: Arc::default(),
        })
    }

    fn bytes(&self) -> MutexGuard<'_, Vec<u8>> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The error of a write, with the file's name.
    pub fn failed(&self, error: impl ToString) -> PresetError {
        PresetError::Write {
            file: self.path.display().to_string(),
            reason: error.to_string(),
        }
    }

    /// A second handle to the file, for a writer that owns one.
    pub fn handle(&self) -> io::Result<Self> {
        Ok(self.clone())
    }

    /// Gives the file its name.
    pub fn commit(self) -> Result<(), PresetError> {
        disk::write(&self.path, &self.bytes()).map_err(|error| self.failed(error))
    }
}

impl Write for InMemory {
    fn write(&mut self, more: &[u8]) -> io::Result<usize> {
        let mut bytes = self.bytes();
        if (bytes.len() + more.len()) as u64 > MOST_BYTES {
            let most = MOST_BYTES >> 20;
            let error =
                format!("it has more than {most} MiB; choose a smaller size or fewer frames");
            return Err(io::Error::other(error));
        }
        bytes.extend(more);
        Ok(more.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
