//! What is decided when files are opened, saved and named.

use std::{path::PathBuf, sync::Arc};

use crate::{effect_files::Hook, effects::Effect};

/// What a file dialog is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    SaveAs,
    Export,
    /// The contact sheet of a sweep.
    Sheet,
}

/// Whose changes of a preset stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Mine,
    Theirs,
    /// Both, key by key; mine where both have changed the same.
    Both,
}

/// What becomes of the scene that is shown when something is opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// The preset brings its own scene.
    WithScene,
    /// Its look lands on the user's own scene, if there is one.
    Look,
    /// A model or built-in scene that is chosen: it takes the look that is shown.
    Scene,
}

/// What happens to a preset that brings effects when the user has decided about them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CodeUse {
    /// It is opened, and this is said.
    Open(Manner, String),
    /// It replaces the open preset, whose file has changed.
    Reload,
}

/// What a new effect begins as.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A commented template.
    Template(Hook),
    /// The text of another effect, which it replaces in the stack.
    Duplicate(Arc<Effect>),
}

/// What a name is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Naming {
    /// Another name for the preset of this file.
    Preset { path: PathBuf, title: String },
    /// A name for the present values of this effect.
    Values(Arc<Effect>),
    /// Another name for the bookmark of this name.
    Bookmark(String),
}
