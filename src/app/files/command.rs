//! Commands that open, save and keep files.

use std::{path::PathBuf, sync::Arc};

use super::favorites::Starred;
use crate::{
    app::settings::last_session::Restored, effect_files::Hook, effects::Effect,
    preset_file::PresetFile,
};

/// What a file dialog is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    SaveAs,
    Export,
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

pub enum FileCommand {
    /// Shows the dialog for this purpose.
    Ask(Purpose),
    /// Shows the system's file dialog, beginning at this path.
    Browse(Purpose, PathBuf),
    /// Opens a preset, model or picture by path, id or `builtin:QUERY`, or enables the effect of a
    /// file.
    Open(String),
    OpenPreset(Box<PresetFile>, Manner),
    /// Opens the preset whose look is shown on the user's own scene, with its scene.
    OpenWithScene,
    /// Opens the preset this many entries further in the gallery, wrapping round.
    OpenNeighbor(isize),
    /// Saves to the preset's own file, or asks for one.
    Save,
    /// Saves there; asks first if effects are muted. A preset that gets another file gets this name,
    /// or that of the file.
    SaveTo {
        path: PathBuf,
        name: Option<String>,
    },
    /// Saves there, without the muted effects if `drops_muted`.
    Write {
        path: PathBuf,
        name: Option<String>,
        drops_muted: bool,
    },
    /// Draws the picture at this size and saves it as a PNG.
    Export {
        path: PathBuf,
        size: [u32; 2],
    },
    /// Downloads every file that the page has as one archive.
    ExportAll,
    /// Asks for the name of a new effect, and for its hook unless it duplicates another effect.
    AskNewEffect(Option<Arc<Effect>>),
    /// Writes a new effect for the user to change, and enables it.
    NewEffect {
        name: String,
        origin: Origin,
    },
    /// Opens a file in the user's editor.
    Edit(PathBuf),
    /// Shows the text of an effect file in the window.
    ShowCode(PathBuf),
    /// Compiles the text of an effect file as it was typed, without saving it.
    TryCode {
        path: PathBuf,
        text: String,
    },
    /// Writes the text of an effect file.
    SaveCode {
        path: PathBuf,
        text: String,
    },
    /// Decides between the open preset and what another program has made of its file. The outcome
    /// is saved to `saving`, if that led to the question.
    Resolve {
        theirs: Box<PresetFile>,
        side: Side,
        saving: Option<PathBuf>,
    },
    /// Goes on with a preset that brings effects, now that the user has decided whether they run.
    UseCode {
        preset_file: Box<PresetFile>,
        then: CodeUse,
        runs: bool,
    },
    /// Goes on with a preset that names a model outside of its folder, now that the user has decided
    /// whether that is opened, or only the look is used; `said` is said of it.
    UseOutside {
        preset_file: Box<PresetFile>,
        manner: Manner,
        said: String,
        opens_model: bool,
    },
    /// Closes the window without saving; the edits may come back at the next start.
    Quit {
        keeps_edits: bool,
    },
    /// Reads what is in a folder.
    List(PathBuf),
    /// Opens what was open in the last session.
    Restore(Box<Restored>),
    /// Forgets the recent files.
    ForgetRecents,
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

/// Favorites, files of presets, and values of effects.
pub enum LibraryCommand {
    /// Makes the preset of this id, or the effect of this name, a favorite (true), or takes its
    /// star away.
    Star(Starred, String, bool),
    AskName(Naming),
    /// Uses the name that was asked for.
    Name(Naming, String),
    /// Writes a copy of the preset, as its file has it.
    Duplicate(Box<PresetFile>),
    /// Moves the preset at this path to the trash.
    Delete(PathBuf),
    /// Puts the preset that was deleted last back.
    Restore,
    /// What was deleted stays in the trash.
    ForgetDeleted,
    /// Puts the effect with its values on the clipboard.
    CopyEffect(Arc<Effect>),
    /// Gives an effect the values of this file.
    UseValues(PathBuf),
    /// Moves this file of values to the trash.
    DeleteValues(PathBuf),
}
