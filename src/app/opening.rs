//! What is being opened: a preset whose model is read first.

use super::scene_loader::SceneKey;
use crate::preset_file::PresetFile;

/// What is being opened.
#[derive(Default)]
pub struct Opening {
    /// The preset whose model is loading, and what is said when it is shown.
    pub waiting: Option<(SceneKey, Box<PresetFile>, String)>,
    /// What is said when this scene is shown.
    pub announced: Option<(SceneKey, String)>,
}

impl Opening {
    pub fn is_waiting(&self) -> bool {
        self.waiting.is_some()
    }
}
