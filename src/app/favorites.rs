//! Favorites: presets and effects that the user has starred, kept in `favorites.toml` of the user's folder.
//!
//! A change is written as a change: the file is read, one name is added or removed, and the file is written again. So two windows do not
//! undo each other's stars.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use toml_edit::{Array, DocumentMut, Item, Value};

use crate::preset_file::{Existing, write_atomically};

/// What can be a favorite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Starred {
    Preset,
    Effect,
}

impl Starred {
    /// The key of the file that lists their names.
    const fn key(self) -> &'static str {
        match self {
            Self::Preset => "presets",
            Self::Effect => "effects",
        }
    }
}

/// A name that becomes a favorite (true), or is none any more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    pub kind: Starred,
    pub name: String,
    pub is_on: bool,
}

/// The favorites, and what of them is not written yet.
#[derive(Debug, Default)]
pub struct Favorites {
    presets: BTreeSet<String>,
    effects: BTreeSet<String>,
    /// The file; without one, favorites last until the window closes.
    path: Option<PathBuf>,
    waiting: Vec<Change>,
    is_writing: bool,
}

impl Favorites {
    /// Those of the user's folder, and what is wrong with their file.
    pub fn load(user: Option<&Path>) -> (Self, Option<String>) {
        let path = user.map(|user| user.join("favorites.toml"));
        let mut favorites = Self { path: path.clone(), ..Self::default() };
        let read = path.filter(|path| path.exists()).map(|path| read(&path));
        match read {
            Some(Ok(document)) => {
                favorites.presets = names(&document, Starred::Preset);
                favorites.effects = names(&document, Starred::Effect);
                (favorites, None)
            }
            Some(Err(error)) => (favorites, Some(error)),
            None => (favorites, None),
        }
    }

    fn set(&self, kind: Starred) -> &BTreeSet<String> {
        match kind {
            Starred::Preset => &self.presets,
            Starred::Effect => &self.effects,
        }
    }

    /// Is the preset of this id, or the effect of this name, a favorite?
    pub fn has(&self, kind: Starred, name: &str) -> bool {
        self.set(kind).contains(name)
    }

    /// Makes it a favorite, or no longer one.
    pub fn change(&mut self, kind: Starred, name: &str, is_on: bool) {
        if self.has(kind, name) == is_on {
            return;
        }
        let set = match kind {
            Starred::Preset => &mut self.presets,
            Starred::Effect => &mut self.effects,
        };
        if is_on {
            set.insert(name.into());
        } else {
            set.remove(name);
        }
        if self.path.is_some() {
            self.waiting.push(Change { kind, name: name.into(), is_on });
        }
    }

    /// What is to be written next, and where; none while something is being written.
    pub fn next_write(&mut self) -> Option<(PathBuf, Vec<Change>)> {
        if self.is_writing || self.waiting.is_empty() {
            return None;
        }
        let path = self.path.clone()?;
        self.is_writing = true;
        Some((path, std::mem::take(&mut self.waiting)))
    }

    /// The last write has ended.
    pub fn written(&mut self) {
        self.is_writing = false;
    }

    pub fn is_busy(&self) -> bool {
        self.is_writing || !self.waiting.is_empty()
    }
}

fn read(path: &Path) -> Result<DocumentMut, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{}: cannot be read: {error}", path.display()))?;
    text.parse().map_err(|error: toml_edit::TomlError| {
        let line = error.span().map_or(1, |span| 1 + text.as_bytes()[..span.start.min(text.len())].iter().filter(|b| **b == b'\n').count());
        format!("{}:{line}: {}; mend or remove the file, until then favorites are not kept", path.display(), error.message().trim())
    })
}

fn names(document: &DocumentMut, kind: Starred) -> BTreeSet<String> {
    let list = document.get(kind.key()).and_then(Item::as_array);
    list.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect()
}

/// Carries out `changes` on the file at `path`, which need not exist. Comments and other keys stay.
///
/// # Errors
/// The file is no TOML, or cannot be read or written: in a sentence. It is then as it was.
pub fn update(path: &Path, changes: &[Change]) -> Result<(), String> {
    let mut document = if path.exists() { read(path)? } else { DocumentMut::new() };
    for Change { kind, name, is_on } in changes {
        let mut names = names(&document, *kind);
        if *is_on {
            names.insert(name.clone());
        } else {
            names.remove(name);
        }
        let list: Array = names.into_iter().collect();
        match document.get_mut(kind.key()).and_then(Item::as_value_mut) {
            Some(before) => {
                let decor = before.decor().clone();
                *before = Value::Array(list);
                *before.decor_mut() = decor;
            }
            None => drop(document.insert(kind.key(), toml_edit::value(list))),
        }
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: the folder cannot be created: {error}", folder.display()))?;
    write_atomically(path, document.to_string().as_bytes(), Existing::Replace).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn star(name: &str, is_on: bool) -> Change {
        Change { kind: Starred::Preset, name: name.into(), is_on }
    }

    #[test]
    fn stars_are_kept_with_the_comments_of_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("user/favorites.toml");
        let (mut favorites, fault) = Favorites::load(Some(&folder.path().join("user")));
        assert_eq!(fault, None);
        favorites.change(Starred::Preset, "comic", true);
        favorites.change(Starred::Effect, "toon", true);
        let (to, changes) = favorites.next_write().expect("two changes");
        assert!(favorites.next_write().is_none(), "one write at a time");
        assert_eq!(to, path);
        update(&to, &changes).expect("a folder that can be written");
        favorites.written();
        assert!(!favorites.is_busy());

        std::fs::write(&path, format!("# mine\n{}other = 1\n", std::fs::read_to_string(&path).expect("a file"))).expect("a file");
        update(&path, &[star("teapot", true), star("comic", false), star("none", false)]).expect("a good file");
        let text = std::fs::read_to_string(&path).expect("a file");
        assert!(text.starts_with("# mine\n") && text.contains("other = 1"), "{text}");
        let (read, fault) = Favorites::load(Some(&folder.path().join("user")));
        assert_eq!(fault, None);
        assert!(read.has(Starred::Preset, "teapot") && !read.has(Starred::Preset, "comic") && read.has(Starred::Effect, "toon"));
    }

    #[test]
    fn two_windows_keep_each_others_stars() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("favorites.toml");
        update(&path, &[star("a", true)]).expect("written");
        update(&path, &[star("b", true)]).expect("written");
        let (read, _) = Favorites::load(Some(folder.path()));
        assert!(read.has(Starred::Preset, "a") && read.has(Starred::Preset, "b"));
    }

    #[test]
    fn a_faulty_file_is_named_with_its_line_and_never_overwritten() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("favorites.toml");
        std::fs::write(&path, "effects = []\npresets = [").expect("a file");
        let (favorites, fault) = Favorites::load(Some(folder.path()));
        assert!(fault.as_ref().is_some_and(|fault| fault.contains("favorites.toml:2")), "{fault:?}");
        assert!(!favorites.has(Starred::Preset, "a"));
        assert!(update(&path, &[star("a", true)]).is_err());
        assert_eq!(std::fs::read_to_string(&path).expect("a file"), "effects = []\npresets = [");
    }

    #[test]
    fn without_a_folder_nothing_is_written() {
        let (mut favorites, fault) = Favorites::load(None);
        favorites.change(Starred::Effect, "toon", true);
        assert!(favorites.has(Starred::Effect, "toon") && !favorites.is_busy() && favorites.next_write().is_none() && fault.is_none());
    }
}
