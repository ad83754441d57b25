//! New effects: writes a commented file for the user to change.

use std::path::{Path, PathBuf};

use super::{log::Level, reload::add_effect_file, state::State};
use crate::{
    effect_files::{Hook, template},
    preset_file::{self, Existing, user_effects_folder},
};

/// Writes the template of a new effect, enables it, and opens it in the user's editor.
pub fn create(state: &mut State, name: &str, hook: Hook) {
    let path = folder(state).join(format!("{name}.wgsl"));
    if path.exists() {
        return state.notify(Level::Error, format!("{} exists; choose another name", path.display()));
    }
    let made = path.parent().map_or(Ok(()), std::fs::create_dir_all).map_err(|error| error.to_string());
    let written = made.and_then(|()| {
        preset_file::write_atomically(&path, template(name, hook).as_bytes(), Existing::Keep).map_err(|error| error.to_string())
    });
    if let Err(error) = written {
        return state.notify(Level::Error, format!("{}: it cannot be written: {error}", path.display()));
    }
    add_effect_file(state, &path);
    state.notify(Level::Info, format!("Wrote {}. Edit it, and the picture changes when you save it.", path.display()));
    if state.live.opens_editor {
        state.jobs.open_editor(path);
    }
}

/// Where a new effect is written: beside the preset, in the folder of effects that is in use, or in the user's own.
fn folder(state: &State) -> PathBuf {
    if let Some(beside) = state.live.watcher.targets().preset_effects() {
        return beside;
    }
    let user = user_effects_folder();
    let in_use = state.folders.effect_folders.iter().rev().find(|folder| Some(*folder) != user.as_ref() && folder.is_dir());
    in_use.cloned().or(user).unwrap_or_else(|| Path::new("effects").to_owned())
}
