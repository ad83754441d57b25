//! Rebinding an open preset: its state, and what is known of its file, use the new text of effects
//! that changed.

use super::file::PresetFile;
use crate::{effect_files::Catalog, preset::rebind::Replaced};

impl PresetFile {
    /// Uses new effects in place of old ones; see
    /// [`Preset::rebind`](crate::preset::Preset::rebind). `effects` are those that the preset
    /// may use from now on.
    pub fn rebind(&mut self, replaced: &[Replaced], effects: Catalog) {
        self.preset.rebind(replaced);
        self.saved.rebind(replaced);
        self.effects = effects;
    }

    /// Do both have the same text on disk, as far as it is known?
    pub fn has_text_of(&self, other: &Self) -> bool {
        self.document.to_string() == other.document.to_string()
    }
}
