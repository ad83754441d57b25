//! Favorites: presets and effects that the user has starred, kept in `favorites.toml` of the user's
//! folder.
//!
//! What has changed since the last write is put into the file as it is then. So two windows do not
//! undo each other's stars.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::plain_file;

/// What can be a favorite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Starred {
    Preset,
    Effect,
}

/// The file: ids of presets and names of effects.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Names {
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    presets: BTreeSet<String>,
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    effects: BTreeSet<String>,
}

/// The favorites, and what of them is not written yet.
#[derive(Debug, Default)]
pub struct Favorites {
    names: Names,
    written: Names,
    /// The file; without one, favorites last until the window closes.
    path: Option<PathBuf>,
    is_writing: bool,
}

impl Favorites {
    /// Those of the user's folder. Each remark is something that cannot be used.
    pub fn load(user: Option<&Path>) -> (Self, Vec<String>) {
        let (path, mut remarks) = (user.map(|user| user.join("favorites.toml")), Vec::new());
        let names: Names = path
            .as_deref()
            .map(|path| plain_file::read(path, &mut remarks).0)
            .unwrap_or_default();
        (
            Self {
                names: names.clone(),
                written: names,
                path,
                is_writing: false,
            },
            remarks,
        )
    }

    /// Is the preset of this id, or the effect of this name, a favorite?
    pub fn has(&self, kind: Starred, name: &str) -> bool {
        match kind {
            Starred::Preset => self.names.presets.contains(name),
            Starred::Effect => self.names.effects.contains(name),
        }
    }

    /// Makes it a favorite, or no longer one.
    pub fn change(&mut self, kind: Starred, name: &str, is_on: bool) {
        let set = match kind {
            Starred::Preset => &mut self.names.presets,
            Starred::Effect => &mut self.names.effects,
        };
        if is_on {
            set.insert(name.into());
        } else {
            set.remove(name);
        }
    }

    /// The next write, to be done on another thread; none while something is being written or
    /// nothing has changed.
    pub fn next_write(&mut self) -> Option<impl FnOnce() -> Result<(), String> + Send + use<>> {
        let path = self
            .path
            .clone()
            .filter(|_| self.is_busy() && !self.is_writing)?;
        let before = std::mem::replace(&mut self.written, self.names.clone());
        self.is_writing = true;
        let now = self.names.clone();
        Some(move || update(&path, &before, &now))
    }

    /// The last write has ended.
    pub fn write_ended(&mut self) {
        self.is_writing = false;
    }

    pub fn is_busy(&self) -> bool {
        self.is_writing || self.path.is_some() && self.names != self.written
    }
}

/// Makes the changes from `before` to `now` in the file at `path`, which need not exist. Its
/// comments stay.
fn update(path: &Path, before: &Names, now: &Names) -> Result<(), String> {
    let mut remarks = Vec::new();
    let (there, mut document) = plain_file::read::<Names>(path, &mut remarks);
    let updated = |there: &BTreeSet<String>,
                   before: &BTreeSet<String>,
                   now: &BTreeSet<String>|
     -> BTreeSet<String> {
        (there - &(before - now))
            .union(&(now - before))
            .cloned()
            .collect()
    };
    let names = Names {
        presets: updated(&there.presets, &before.presets, &now.presets),
        effects: updated(&there.effects, &before.effects, &now.effects),
    };
    plain_file::write(&names, &mut document, path)?;
    if remarks.is_empty() {
        Ok(())
    } else {
        Err(remarks.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(favorites: &mut Favorites) {
        let write = favorites.next_write().expect("a change");
        assert!(favorites.next_write().is_none(), "one write at a time");
        write().expect("a folder that can be written");
        favorites.write_ended();
        assert!(!favorites.is_busy());
    }

    #[test]
    fn stars_are_kept_with_the_comments_of_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let (user, path) = (
            folder.path().join("user"),
            folder.path().join("user/favorites.toml"),
        );
        let (mut favorites, remarks) = Favorites::load(Some(&user));
        assert_eq!(remarks, [""; 0]);
        favorites.change(Starred::Preset, "comic", true);
        favorites.change(Starred::Effect, "toon", true);
        write(&mut favorites);
        std::fs::write(
            &path,
            format!(
                "# mine\n{}",
                std::fs::read_to_string(&path).expect("a file")
            ),
        )
        .expect("a file");
        favorites.change(Starred::Preset, "teapot", true);
        favorites.change(Starred::Preset, "comic", false);
        favorites.change(Starred::Preset, "none", false);
        write(&mut favorites);
        assert_eq!(
            std::fs::read_to_string(&path).expect("a file"),
            "# mine\npresets = [\"teapot\"]\neffects = [\"toon\"]\n"
        );
        let (read, remarks) = Favorites::load(Some(&user));
        assert_eq!((read.names, remarks), (favorites.names, vec![]));
    }

    #[test]
    fn two_windows_keep_each_others_stars() {
        let folder = tempfile::tempdir().expect("a folder");
        let [mut first, mut second] = [0, 1].map(|_| Favorites::load(Some(folder.path())).0);
        first.change(Starred::Preset, "a", true);
        write(&mut first);
        second.change(Starred::Preset, "b", true);
        write(&mut second);
        first.change(Starred::Preset, "a", false);
        write(&mut first);
        let (read, _) = Favorites::load(Some(folder.path()));
        assert!(!read.has(Starred::Preset, "a") && read.has(Starred::Preset, "b"));
    }

    #[test]
    fn a_faulty_file_is_named_with_its_line_and_put_aside() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(
            folder.path().join("favorites.toml"),
            "effects = []\npresets = [",
        )
        .expect("a file");
        let (favorites, remarks) = Favorites::load(Some(folder.path()));
        assert!(
            remarks.len() == 1 && remarks[0].contains("favorites.toml, line 2"),
            "{remarks:?}"
        );
        assert!(!favorites.has(Starred::Preset, "a"));
        let aside = folder.path().join("favorites.toml.broken");
        assert_eq!(
            std::fs::read_to_string(aside).expect("it is kept"),
            "effects = []\npresets = ["
        );
    }

    #[test]
    fn without_a_folder_nothing_is_written() {
        let (mut favorites, remarks) = Favorites::load(None);
        favorites.change(Starred::Effect, "toon", true);
        assert!(
            favorites.has(Starred::Effect, "toon")
                && !favorites.is_busy()
                && favorites.next_write().is_none()
                && remarks.is_empty()
        );
    }
}
