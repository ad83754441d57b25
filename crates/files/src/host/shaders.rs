//! Shaders in a folder, for people who edit them.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use crate::shader::library::{Library, ShaderFiles};

/// The library of a folder, whose files are read each time they are asked for.
pub fn library(folder: &Path) -> Library {
    Library::Outside(Arc::new(Folder(folder.to_owned())))
}

struct Folder(PathBuf);

impl ShaderFiles for Folder {
    fn text(&self, name: &str) -> Option<String> {
        fs::read_to_string(self.0.join(format!("{name}.wgsl"))).ok()
    }

    fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.0.join(folder)).into_iter().flatten();
        entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.extension().is_some_and(|end| end == "wgsl"))
            .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
            .collect()
    }

    /// Adds the names to the file that `RASTERLAB_PARTS` names: `scripts/mutants.py` asks which
    /// parts a command uses.
    fn linked(&self, parts: &mut dyn Iterator<Item = &str>) {
        if let Some(path) = std::env::var_os("RASTERLAB_PARTS") {
            let names: String = parts.map(|name| format!("{name}\n")).collect();
            let file = fs::OpenOptions::new().create(true).append(true).open(path);
            // The script takes a missing file for a command that uses every part.
            let _ = file.and_then(|mut file| file.write_all(names.as_bytes()));
        }
    }
}

/// Makes all renderers take their shaders from `folder`, or else from the folder of
/// `RASTERLAB_SHADERS`; without either they take those inside the program. Only the first call
/// counts. Returns the folder.
pub fn choose(folder: Option<PathBuf>) -> Option<&'static Path> {
    static CHOSEN: OnceLock<Option<PathBuf>> = OnceLock::new();
    let choose = || {
        let folder = folder.or_else(|| std::env::var_os("RASTERLAB_SHADERS").map(PathBuf::from));
        folder.iter().for_each(|folder| library(folder).choose());
        folder
    };
    CHOSEN.get_or_init(choose).as_deref()
}
