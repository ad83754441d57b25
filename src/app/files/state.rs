//! What the window knows of files.

use std::{collections::HashSet, path::PathBuf};

use super::{deleted::Deleted, favorites::Favorites, live::Live, opening::Opening};
use crate::{
    app::editing::trust::Trust,
    preset_file::{Folders, SavedValues},
};

/// What the window knows of files: where they are, which are open or watched, and which are gone.
pub struct FileState {
    /// Where presets and effects are, beside the user's own presets.
    pub folders: Folders,
    /// What is watched on disk.
    pub live: Live,
    /// Effects that came inside presets and may run.
    pub trust: Trust,
    pub favorites: Favorites,
    /// Files that were moved to the trash since the start, the newest last.
    pub deleted: Vec<Deleted>,
    /// Saved values of effects.
    pub values: Vec<SavedValues>,
    /// The preset that is being opened.
    pub opening: Opening,
    /// Recent files that are not there.
    pub missing_files: HashSet<PathBuf>,
}
