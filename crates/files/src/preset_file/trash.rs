//! The trash: a folder that deleted files are moved to, each into a folder of its own together with where it came from.

use std::{
    io,
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

use super::{
    atomic::{Existing, write_atomically},
    error::PresetError,
    file::stem,
};

/// The file that holds the path that a deleted file had.
const ORIGIN: &str = "from.txt";

/// A file in the trash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trashed {
    /// Where it was.
    pub from: PathBuf,
    /// Where it is.
    pub file: PathBuf,
}

impl Trashed {
    /// The name that it had, without its extension.
    pub fn name(&self) -> String {
        stem(&self.from)
    }
}

/// Moves the file at `path` to `trash`, which is created if it does not exist.
///
/// # Errors
/// The file cannot be moved; then it is where it was.
pub fn move_to_trash(path: &Path, trash: &Path) -> Result<Trashed, PresetError> {
    let failed =
        |error: io::Error| PresetError::Write { file: path.display().to_string(), reason: format!("it cannot be deleted: {error}") };
    let from = std::path::absolute(path).map_err(failed)?;
    let name = from.file_name().ok_or_else(|| failed(io::ErrorKind::InvalidFilename.into()))?;
    let folder = new_folder(trash, &stem(path)).map_err(failed)?;
    let file = folder.join(name);
    let moved = || -> io::Result<()> {
        std::fs::write(folder.join(ORIGIN), from.to_string_lossy().as_bytes())?;
        match std::fs::rename(&from, &file) {
            // The trash may be on another disk.
            Err(error) if error.kind() == io::ErrorKind::CrossesDevices => {
                std::fs::copy(&from, &file)?;
                std::fs::remove_file(&from)
            }
            moved => moved,
        }
    };
    if let Err(error) = moved() {
        if from.exists() || !file.exists() {
            drop(std::fs::remove_dir_all(&folder));
        }
        return Err(failed(error));
    }
    Ok(Trashed { from, file })
}

/// A new folder in `trash`, named after the time and the file.
fn new_folder(trash: &Path, name: &str) -> io::Result<PathBuf> {
    std::fs::create_dir_all(trash)?;
    let now_ms = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |passed| passed.as_millis());
    for number in now_ms.. {
        // Of one width, so that names are in the order of time.
        let folder = trash.join(format!("{number:016}-{name}"));
        match std::fs::create_dir(&folder) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            created => return created.map(|()| folder),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// Moves a file of the trash back to where it was; under a name with a number if another file has taken its name. Returns its path.
///
/// # Errors
/// The file cannot be read or written; then it stays in the trash.
pub fn restore(trashed: &Trashed) -> Result<PathBuf, PresetError> {
    let failed = |error: io::Error| PresetError::Read { file: trashed.file.display().to_string(), reason: error.to_string() };
    let bytes = std::fs::read(&trashed.file).map_err(failed)?;
    let (folder, name) = (trashed.from.parent().unwrap_or(Path::new("")), trashed.name());
    std::fs::create_dir_all(folder).map_err(failed)?;
    let extension = trashed.from.extension().map_or_else(String::new, |extension| format!(".{}", extension.to_string_lossy()));
    for number in 1.. {
        let path = if number == 1 { trashed.from.clone() } else { folder.join(format!("{name}-{number}{extension}")) };
        match write_atomically(&path, &bytes, Existing::Keep) {
            Err(PresetError::Exists { .. }) => {}
            Err(error) => return Err(error),
            Ok(()) => {
                if let Some(own) = trashed.file.parent() {
                    // It is where it belongs. What stays in the trash is a copy.
                    drop(std::fs::remove_dir_all(own));
                }
                return Ok(path);
            }
        }
    }
    unreachable!("every number is tried")
}

/// What is in the trash, the newest first.
pub fn trashed(trash: &Path) -> Vec<Trashed> {
    let mut folders: Vec<PathBuf> = std::fs::read_dir(trash).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    folders.sort();
    let item = |folder: &PathBuf| {
        let from = PathBuf::from(std::fs::read_to_string(folder.join(ORIGIN)).ok()?);
        let file = folder.join(from.file_name()?);
        file.is_file().then_some(Trashed { from, file })
    };
    folders.iter().rev().filter_map(item).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deleted_file_comes_back_with_its_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, trash) = (folder.path().join("mine.toml"), folder.path().join("trash"));
        std::fs::write(&path, b"schema = 2\r\n# \xff").expect("a file");
        let item = move_to_trash(&path, &trash).expect("moved");
        assert!(!path.exists() && item.file.is_file());
        assert_eq!((trashed(&trash), item.name()), (vec![item.clone()], "mine".into()));
        assert_eq!(restore(&item).expect("moved back"), path);
        assert_eq!(std::fs::read(&path).expect("a file"), b"schema = 2\r\n# \xff");
        assert!(trashed(&trash).is_empty());
        assert!(restore(&item).is_err(), "it is there already");
    }

    #[test]
    fn a_file_that_has_taken_the_name_stays_and_so_does_every_deleted_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let (path, trash) = (folder.path().join("mine.toml"), folder.path().join("trash"));
        let items = ["first", "second"].map(|text| {
            std::fs::write(&path, text).expect("a file");
            move_to_trash(&path, &trash).expect("moved")
        });
        assert_eq!(trashed(&trash), [items[1].clone(), items[0].clone()], "the newest first");
        std::fs::write(&path, "third").expect("a file");
        assert_eq!(restore(&items[0]).expect("moved back"), folder.path().join("mine-2.toml"));
        assert_eq!(restore(&items[1]).expect("moved back"), folder.path().join("mine-3.toml"));
        let texts =
            ["mine", "mine-2", "mine-3"].map(|name| std::fs::read_to_string(folder.path().join(format!("{name}.toml"))).expect("a file"));
        assert_eq!(texts, ["third", "first", "second"]);
    }

    #[test]
    fn a_file_that_is_not_there_is_an_error_and_leaves_no_trace() {
        let folder = tempfile::tempdir().expect("a folder");
        let trash = folder.path().join("trash");
        let error = move_to_trash(&folder.path().join("none.toml"), &trash).expect_err("no file").to_string();
        assert!(error.contains("none.toml") && error.contains("cannot be deleted"), "{error}");
        assert!(trashed(&trash).is_empty() && std::fs::read_dir(&trash).expect("a folder").next().is_none());
        assert!(trashed(Path::new("/no/such/folder")).is_empty());
    }
}
