//! Models on disk. A model file is read to where its bytes belong, and it reaches only files in its
//! folder and below.
//!
//! Files are read, not mapped: one that another program cuts short while it is mapped would end the
//! program.

use std::{
    cell::Cell,
    ffi::OsString,
    io::{self, Read as _, Seek as _, SeekFrom},
    ops::Range,
    path::{Path, PathBuf},
};

use super::disk;
use crate::{
    params::{legible_line, text_of},
    scene::{
        Scene,
        gltf::{self, LoadError, PART_BYTES, ReadFile, Source, limits::Limits, reserve},
        memory::MemoryBudget,
    },
    work::checkpoint,
};

/// Loads a glTF file (`.gltf`, `.glb`, `.vrm`) within the memory budget of the process.
pub fn load(path: &Path) -> Result<Scene, LoadError> {
    load_within(path, MemoryBudget::of_process())
}

/// [`load`] within another memory budget.
pub fn load_within(path: &Path, budget: MemoryBudget) -> Result<Scene, LoadError> {
    load_as(path, budget, gltf::load_within)
}

/// Loads a model file with a loader of its format. Only files in its folder and below are read.
///
/// Within [`Work`](crate::work::Work) it counts its bytes, and unwinds where that was canceled.
pub fn load_as(
    path: &Path,
    budget: MemoryBudget,
    load_model: impl FnOnce(&dyn Source, MemoryBudget, &mut ReadFile) -> Result<Scene, LoadError>,
) -> Result<Scene, LoadError> {
    let file = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned();
    let name = path
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned())
        .unwrap_or_default();
    let limits = Limits::of_files(budget);
    let load = || {
        let model = OpenFile::open(path, limits.file_bytes, &limits)?;
        let scene = load_model(&model, budget, &mut |beside, most| {
            read_beside(path, beside, most, &limits)
        })?;
        checkpoint().advance(model.unread())?;
        Ok(scene)
    };
    match load() {
        Ok(scene) => Ok(Scene { name, ..scene }),
        Err(error) => Err(LoadError::within(error, legible_line(&file))),
    }
}

/// Reads `beside`, a relative path without `..`, from the folder of `model`. Symbolic links must
/// not lead out of the folder.
fn read_beside(
    model: &Path,
    beside: &Path,
    most: u64,
    limits: &Limits,
) -> Result<Vec<u8>, LoadError> {
    let folder = model
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let folder = disk::canonical(folder).map_err(failed)?;
    let path = disk::canonical(&folder.join(beside)).or_else(|error| {
        let similar = similar(&folder, beside).ok_or(error)?;
        disk::canonical(&similar)
    });
    let path = path.map_err(failed)?;
    if !path.starts_with(&folder) {
        return Err(LoadError::new(
            "it lies outside the model's folder; copy it there",
        ));
    }
    let file = OpenFile::open(&path, most, limits)?;
    let mut bytes = Vec::new();
    reserve(&mut bytes, file.size)?;
    file.append_to(&mut bytes, 0..file.size)?;
    Ok(bytes)
}

/// The only file below `folder` that `wanted` may mean: its name has the same bytes, in whatever
/// encoding, or other cases of the same letters.
fn similar(folder: &Path, wanted: &Path) -> Option<PathBuf> {
    let mut path = folder.to_owned();
    for part in wanted {
        let exact = path.join(part);
        if disk::exists(&exact) {
            path = exact;
            continue;
        }
        let wanted = part.to_str()?;
        let names = disk::names_in(&path)?;
        let text = |name: &OsString| text_of(name.as_encoded_bytes()).into_owned();
        let same = names.iter().find(|name| text(name) == wanted);
        let folded = wanted.to_lowercase();
        let mut alike = names
            .iter()
            .filter(|name| text(name).to_lowercase() == folded);
        let only = alike.next().filter(|_| alike.next().is_none());
        path.push(same.or(only)?);
    }
    Some(path)
}

/// A regular file, and how much of it was read.
struct OpenFile {
    file: disk::File,
    size: u64,
    read: Cell<u64>,
}

impl OpenFile {
    /// Opens a regular file of at most `most` bytes and counts them as expected. Pipes, devices and
    /// folders are refused before they are opened.
    fn open(path: &Path, most: u64, limits: &Limits) -> Result<Self, LoadError> {
        let Some(size) = disk::size_of(path).map_err(failed)? else {
            return Err(LoadError::new("it is not a regular file"));
        };
        if size > most {
            return Err(limits.exceeded(format_args!("it has {size} bytes"), most));
        }
        let file = disk::open(path).map_err(failed)?;
        checkpoint().expect(size);
        Ok(Self {
            file,
            size,
            read: Cell::new(0),
        })
    }

    /// Bytes that are not read yet.
    fn unread(&self) -> u64 {
        self.size.saturating_sub(self.read.get())
    }
}

impl Source for OpenFile {
    fn size(&self) -> u64 {
        self.size
    }

    fn append_to(&self, bytes: &mut Vec<u8>, range: Range<u64>) -> Result<(), LoadError> {
        let mut file = &self.file;
        file.seek(SeekFrom::Start(range.start)).map_err(failed)?;
        let (mut left, checkpoint) = (range.end - range.start, checkpoint());
        while left > 0 {
            let read = file
                .take(left.min(PART_BYTES as u64))
                .read_to_end(bytes)
                .map_err(failed)? as u64;
            if read == 0 {
                return Err(LoadError::new(
                    "the file has become shorter while it was read; load it again",
                ));
            }
            left -= read;
            self.read.set(self.read.get() + read);
            checkpoint.advance(read)?;
        }
        Ok(())
    }
}

fn failed(error: io::Error) -> LoadError {
    LoadError::new(format!("cannot read the file: {error}"))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_file_that_becomes_shorter_while_it_is_read_is_an_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("model.glb");
        fs::write(&path, [1; 200]).expect("a file");
        let file = OpenFile::open(&path, 1 << 20, &Limits::of_files(MemoryBudget::LEAST))
            .expect("a regular file");
        fs::File::options()
            .write(true)
            .open(&path)
            .and_then(|file| file.set_len(100))
            .expect("it can be cut");
        let mut bytes = Vec::new();
        assert_eq!(file.append_to(&mut bytes, 10..30), Ok(()));
        let shorter = Err(LoadError::new(
            "the file has become shorter while it was read; load it again",
        ));
        assert_eq!(file.append_to(&mut bytes, 50..150), shorter);
        assert_eq!((bytes.len(), file.unread()), (70, 130));
    }
}
