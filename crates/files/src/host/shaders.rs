//! Shaders in a folder, for people who edit them.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use crate::shader::library::Library;

/// The library of a folder, whose files are read each time they are asked for.
pub fn library(folder: &Path) -> Library {
    let folder = folder.to_owned();
    Library::Outside(Arc::new(move |name| fs::read_to_string(folder.join(format!("{name}.wgsl"))).ok()))
}

/// Makes all renderers take their shaders from `folder`, or else from the folder of `RASTERLAB_SHADERS`; without either they take those inside
/// the program. Only the first call counts. Returns the folder.
pub fn choose(folder: Option<PathBuf>) -> Option<&'static Path> {
    static CHOSEN: OnceLock<Option<PathBuf>> = OnceLock::new();
    let choose = || {
        let folder = folder.or_else(|| std::env::var_os("RASTERLAB_SHADERS").map(PathBuf::from));
        folder.iter().for_each(|folder| library(folder).choose());
        folder
    };
    CHOSEN.get_or_init(choose).as_deref()
}
