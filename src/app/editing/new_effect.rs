//! New effects: writes a file for the user to change, a commented template or the duplicate of
//! another effect.

use std::path::{Path, PathBuf};

use crate::{
    app::{
        App,
        files::{command::Origin, reload::add_effect_file},
        shell::{log::Level, state::State},
    },
    effect_files::{duplicate, template},
    host::disk,
    preset_file::{self, Existing, user_effects_folder},
};

/// Writes the file of a new effect on another thread; [`written`] takes the outcome.
pub fn create(state: &mut State, name: &str, origin: Origin) {
    let (path, name) = (folder(state).join(format!("{name}.wgsl")), name.to_owned());
    state.files.live.writing += 1;
    state.jobs.write_effect(path, origin.clone(), move |path| {
        let text = match &origin {
            Origin::Template(hook) => template(&name, *hook),
            Origin::Duplicate(effect) => {
                duplicate(effect, &name).map_err(|reason| format!("{} {reason}", effect.name))?
            }
        };
        write(path, &text)
    });
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    if path.exists() {
        return Err(format!("{} exists; choose another name", path.display()));
    }
    let made = path
        .parent()
        .map_or(Ok(()), std::fs::create_dir_all)
        .map_err(|error| error.to_string());
    let written = made.and_then(|()| {
        preset_file::write_atomically(path, text.as_bytes(), Existing::Keep)
            .map_err(|error| error.to_string())
    });
    written.map_err(|error| format!("{}: it cannot be written: {error}", path.display()))
}

/// Enables an effect that was written, in place of the one that it duplicates.
pub fn written(app: &mut App, path: PathBuf, origin: Origin, outcome: Result<(), String>) {
    app.state.files.live.writing = app.state.files.live.writing.saturating_sub(1);
    if let Err(error) = outcome {
        return app.notify(Level::Error, error);
    }
    add_effect_file(app, &path);
    app.state.jobs.read_code(path.clone());
    if let (Some(waiting), Origin::Duplicate(effect)) = (&mut app.state.files.live.enable, origin) {
        waiting.replaces = Some(effect);
    }
    app.notify(
        Level::Info,
        format!(
            "Wrote {}. The picture follows its text here, and its file in any editor.",
            path.display()
        ),
    );
}

/// Where a new effect is written: beside the preset, unless that lies in the folder of `--presets`, in
/// the folder of effects that is in use, or in the user's own.
pub fn folder(state: &State) -> PathBuf {
    let beside = state.files.live.watcher.targets().preset_effects();
    let absolute = |folder: &Path| disk::absolute(folder).ok();
    let gallery = state.files.folders.presets.as_deref().and_then(absolute);
    let is_own = |beside: &PathBuf| gallery != beside.parent().and_then(absolute);
    if let Some(beside) = beside.filter(is_own) {
        return beside;
    }
    let user = user_effects_folder();
    let in_use = state
        .files
        .folders
        .effect_folders
        .iter()
        .rev()
        .find(|folder| Some(*folder) != user.as_ref() && folder.is_dir());
    in_use
        .cloned()
        .or(user)
        .unwrap_or_else(|| Path::new("effects").to_owned())
}
