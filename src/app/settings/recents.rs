//! Recent files: what was opened or saved last, newest first.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::{
    host::disk,
    preset::SceneSource,
    preset_file::{self, PresetFile},
};

/// Files that are remembered.
pub const CAPACITY: usize = 12;

/// What was opened or saved last, newest first; absolute paths, each once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<String>", into = "Vec<String>")]
pub struct Recents(Vec<PathBuf>);

impl Recents {
    /// Puts `path` first.
    pub fn add(&mut self, path: &Path) {
        let Some(path) = preset_file::normalized(path) else {
            return;
        };
        self.0.retain(|known| *known != path);
        self.0.insert(0, path);
        self.0.truncate(CAPACITY);
    }

    /// Puts the file of a preset first, or that of its model if it has none.
    pub fn add_opened(&mut self, opened: &PresetFile) {
        match (&opened.path, &opened.preset.scene) {
            (Some(path), _) => self.add(path),
            (None, SceneSource::File(model)) if !opened.read_only => self.add(model),
            _ => {}
        }
    }

    /// The file `from` is called `to` now.
    pub fn rename(&mut self, from: &Path, to: &Path) {
        let [Ok(from), Ok(to)] = [from, to].map(disk::absolute) else {
            return;
        };
        if self.0.contains(&from) {
            self.0.retain(|known| *known != to);
            self.0
                .iter_mut()
                .filter(|known| **known == from)
                .for_each(|known| known.clone_from(&to));
        }
    }

    /// Forgets `path`.
    pub fn remove(&mut self, path: &Path) {
        if let Ok(path) = disk::absolute(path) {
            self.0.retain(|known| *known != path);
        }
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Newest first.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Path> {
        self.0.iter().map(PathBuf::as_path)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Reads a list, newest first.
impl<P: AsRef<Path>> FromIterator<P> for Recents {
    fn from_iter<I: IntoIterator<Item = P>>(paths: I) -> Self {
        let mut recents = Self::default();
        for path in paths {
            let path = path.as_ref();
            if path.is_absolute()
                && !recents.0.iter().any(|known| known == path)
                && recents.0.len() < CAPACITY
            {
                recents.0.push(path.to_owned());
            }
        }
        recents
    }
}

impl From<Vec<String>> for Recents {
    fn from(paths: Vec<String>) -> Self {
        paths.iter().collect()
    }
}

impl From<Recents> for Vec<String> {
    fn from(recents: Recents) -> Self {
        recents
            .iter()
            .map(|path| path.to_string_lossy().into_owned())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_is_first_each_once_and_there_are_at_most_twelve() {
        let mut recents = Recents::default();
        (0..20).for_each(|i| recents.add(Path::new(&format!("/models/{i}.glb"))));
        recents.add(Path::new("/models/15.glb"));
        let names: Vec<_> = recents
            .iter()
            .map(|path| {
                path.file_stem()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        assert_eq!(
            names,
            [
                "15", "19", "18", "17", "16", "14", "13", "12", "11", "10", "9", "8"
            ]
        );
        assert_eq!(recents.iter().collect::<Recents>(), recents);
    }

    #[test]
    fn a_renamed_file_keeps_its_place_and_a_deleted_one_is_gone() {
        let mut recents = Recents::default();
        ["/c.toml", "/b.toml", "/a.toml"]
            .iter()
            .for_each(|path| recents.add(Path::new(path)));
        recents.rename(Path::new("/b.toml"), Path::new("/d.toml"));
        recents.rename(Path::new("/unknown.toml"), Path::new("/e.toml"));
        assert_eq!(
            recents.iter().collect::<Vec<_>>(),
            ["/a.toml", "/d.toml", "/c.toml"].map(Path::new)
        );
        recents.remove(Path::new("/a.toml"));
        assert_eq!(
            recents.iter().collect::<Vec<_>>(),
            ["/d.toml", "/c.toml"].map(Path::new)
        );
    }

    #[test]
    fn relative_paths_become_absolute() {
        let mut recents = Recents::default();
        recents.add(Path::new("fox.glb"));
        assert!(recents.iter().all(Path::is_absolute));
        assert!(
            ["fox.glb"].iter().collect::<Recents>().is_empty(),
            "a list of the settings file has absolute paths"
        );
    }

    #[test]
    fn a_preset_stands_for_its_file_and_a_model_for_itself() {
        let mut recents = Recents::default();
        let mut preset_file =
            PresetFile::of_scene("fox", SceneSource::File("/models/fox.glb".into()));
        recents.add_opened(&preset_file);
        preset_file.path = Some("/presets/mine.toml".into());
        recents.add_opened(&preset_file);
        recents.add_opened(&PresetFile::of_scene(
            "teapot",
            SceneSource::Builtin("teapot".into()),
        ));
        assert_eq!(
            recents.iter().collect::<Vec<_>>(),
            [
                Path::new("/presets/mine.toml"),
                Path::new("/models/fox.glb")
            ]
        );
    }
}
