//! Deleted files: they go to the trash of the system, and their bytes are kept, so that Undo needs
//! nothing from it.

use std::path::{Path, PathBuf};

use crate::preset_file::{Existing, PresetError, write_atomically};

/// A file that was moved to the trash.
pub struct Deleted {
    /// Where it was.
    pub path: PathBuf,
    bytes: Vec<u8>,
}

impl Deleted {
    /// Moves the file at `path` to the trash of the system.
    ///
    /// # Errors
    /// The file cannot be read or moved, in a sentence; then it is where it was.
    pub fn delete(path: &Path) -> Result<Self, String> {
        let failed = |reason: String| format!("{}: it cannot be deleted: {reason}", path.display());
        let read = || {
            Ok(Self {
                path: std::path::absolute(path)?,
                bytes: std::fs::read(path)?,
            })
        };
        let deleted = read().map_err(|error: std::io::Error| failed(error.to_string()))?;
        move_to_trash(path).map_err(failed)?;
        Ok(deleted)
    }

    /// The name that it had, without its extension.
    pub fn name(&self) -> String {
        self.path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    }

    /// Writes the file again where it was; under a name with a number if another file has taken its
    /// name. Returns its path.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn restore(&self) -> Result<PathBuf, PresetError> {
        if let Some(folder) = self.path.parent() {
            // Where it cannot be created, the error of the file says so.
            drop(std::fs::create_dir_all(folder));
        }
        let extension = self.path.extension().map_or_else(String::new, |extension| {
            format!(".{}", extension.to_string_lossy())
        });
        let numbered = (2..).map(|number| {
            self.path
                .with_file_name(format!("{}-{number}{extension}", self.name()))
        });
        for path in std::iter::once(self.path.clone()).chain(numbered) {
            match write_atomically(&path, &self.bytes, Existing::Keep) {
                Err(PresetError::Exists { .. }) => {}
                written => return written.map(|()| path),
            }
        }
        unreachable!("every number is tried")
    }
}

#[cfg(not(target_arch = "wasm32"))]
fn move_to_trash(path: &Path) -> Result<(), String> {
    use std::error::Error as _;

    trash::delete(path).map_err(|error| {
        error
            .source()
            .map_or_else(|| error.to_string(), ToString::to_string)
    })
}

#[cfg(target_arch = "wasm32")]
fn move_to_trash(_: &Path) -> Result<(), String> {
    Err("a page has no trash".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Removes what the test has put into the trash of the system, where that can be listed.
    fn empty_trash_of(folder: &Path) {
        #[cfg(any(windows, target_os = "linux"))]
        {
            let items = trash::os_limited::list().expect("a trash");
            let own: Vec<_> = items
                .into_iter()
                .filter(|item| item.original_parent == folder)
                .collect();
            assert!(!own.is_empty(), "the deleted files are in the trash");
            trash::os_limited::purge_all(own).expect("a trash");
        }
    }

    #[test]
    fn deleted_files_come_back_with_their_bytes_and_the_file_that_has_taken_the_name_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        let home = folder.path().canonicalize().expect("a folder");
        let path = home.join("mine.toml");
        let deleted = [&b"schema = 2\r\n# \xff"[..], b"second"].map(|bytes| {
            std::fs::write(&path, bytes).expect("a file");
            let deleted = Deleted::delete(&path).expect("moved");
            assert!(!path.exists() && deleted.name() == "mine");
            deleted
        });
        empty_trash_of(&home);
        assert_eq!(deleted[0].restore().expect("written"), path);
        assert_eq!(
            std::fs::read(&path).expect("a file"),
            b"schema = 2\r\n# \xff"
        );
        assert_eq!(
            deleted[1].restore().expect("written"),
            home.join("mine-2.toml")
        );
        assert_eq!(
            deleted[1].restore().expect("written"),
            home.join("mine-3.toml")
        );
        assert_eq!(
            std::fs::read(home.join("mine-3.toml")).expect("a file"),
            b"second"
        );
    }

    #[test]
    fn a_file_that_is_not_there_is_an_error() {
        let error = Deleted::delete(Path::new("/no/such/folder/none.toml"))
            .err()
            .expect("no file");
        assert!(
            error.contains("none.toml")
                && error.contains("cannot be deleted")
                && error.lines().count() == 1,
            "{error}"
        );
    }
}
