//! Where the goldens of presets lie.

use std::path::{Path, PathBuf};

use super::file::PresetFile;

/// The folder that the project's own presets share, from the current folder.
const SHARED: &str = "tests/snapshots";

/// The folder of a preset's golden: `snapshots` beside the preset, or the shared one,
/// `tests/snapshots`. Where neither exists, the golden of a preset file begins the one beside it.
pub fn golden_folder(preset_file: &PresetFile) -> PathBuf {
    let beside = preset_file
        .path
        .as_deref()
        .map(|path| path.with_file_name("snapshots"));
    match beside {
        Some(beside) if beside.is_dir() || !Path::new(SHARED).is_dir() => beside,
        _ => SHARED.into(),
    }
}

/// The picture and the sidecar of the preset `id` in a folder of goldens.
pub fn golden_paths(folder: &Path, id: &str) -> [PathBuf; 2] {
    [
        folder.join(format!("{id}.png")),
        folder.join(format!("{id}.json")),
    ]
}
