//! Where the look of a preset comes from that has landed on another scene.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::file::PresetFile;

/// The preset that a look comes from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Look {
    pub id: String,
    pub path: Option<PathBuf>,
    pub title: String,
}

impl Look {
    /// That of a preset.
    pub fn of(preset_file: &PresetFile) -> Self {
        Self {
            id: preset_file.id.clone(),
            path: preset_file.path.clone(),
            title: preset_file.title().to_owned(),
        }
    }
}
