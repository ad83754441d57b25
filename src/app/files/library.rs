//! The user's library: favorites, files of presets, and values of effects.

use std::{path::Path, sync::Arc};

use eframe::egui;

use super::{
    command::{LibraryCommand, Naming},
    deleted::Deleted,
};
use crate::{
    app::{
        editing::{
            history::History,
            session::{FileId, UndoState},
        },
        panels::Panels,
        shell::{command::Edit, log::Level, state::State},
    },
    effects::Effect,
    host::disk,
    preset_file::{self, EffectValues, PresetError, PresetFile},
};

/// Carries out `command`.
pub fn library(
    ctx: &egui::Context,
    state: &mut State,
    panels: &mut Panels,
    command: LibraryCommand,
) {
    match command {
        LibraryCommand::Star(kind, name, is_on) => {
            state.files.favorites.change(kind, &name, is_on);
            write_favorites(state);
        }
        LibraryCommand::AskName(naming) => panels.naming.ask(naming),
        LibraryCommand::Name(naming, name) => match named(state, panels, &naming, &name) {
            Ok(text) => state.notify(Level::Info, text),
            Err(error) => panels.naming.refuse(naming, name, error),
        },
        LibraryCommand::Duplicate(source) => {
            notify_outcome(state, |state| duplicate(state, panels, &source))
        }
        LibraryCommand::Delete(path) => notify_outcome(state, |state| delete(state, panels, &path)),
        LibraryCommand::Restore => notify_outcome(state, |state| restore(state, panels)),
        LibraryCommand::ForgetDeleted => state.files.deleted.clear(),
        LibraryCommand::CopyEffect(effect) => copy_effect(ctx, state, &effect),
        LibraryCommand::UseValues(path) => {
            let loaded = preset_file::load_values(&path, &state.session.preset_file.effects);
            notify_outcome(state, |state| {
                put(state, &loaded.map_err(sentence)?, "Took the values of")
            });
        }
        LibraryCommand::DeleteValues(path) => {
            notify_outcome(state, |state| delete_values(state, &path))
        }
    }
}

/// Says what was done, or why it was not.
fn notify_outcome(state: &mut State, change: impl FnOnce(&mut State) -> Result<String, String>) {
    match change(state) {
        Ok(text) => state.notify(Level::Info, text),
        Err(error) => state.notify(Level::Error, error),
    }
}

fn sentence(error: PresetError) -> String {
    error.to_string()
}

/// Writes the favorites that have changed, unless that is going on.
pub fn write_favorites(state: &mut State) {
    if let Some(write) = state.files.favorites.next_write() {
        state.jobs.write_favorites(write);
    }
}

/// Does with `name` what it was asked for.
fn named(
    state: &mut State,
    panels: &mut Panels,
    naming: &Naming,
    name: &str,
) -> Result<String, String> {
    match naming {
        Naming::Preset { path, .. } => rename(state, panels, path, name),
        Naming::Values(effect) => save_values(state, effect, name),
        Naming::Bookmark(from) => {
            let to = name.trim();
            let edit = Edit::RenameBookmark(from.clone(), to.to_owned());
            state
                .session
                .edit(edit)
                .map(|()| format!("Renamed to {to}"))
        }
    }
}

fn rename(
    state: &mut State,
    panels: &mut Panels,
    path: &Path,
    name: &str,
) -> Result<String, String> {
    let open = open_at(state, path);
    if open.as_ref().is_some_and(|id| !is_known(state, id)) {
        return Err(format!(
            "Another program has changed {}. Save or reload it, then rename it",
            path.display()
        ));
    }
    let before = preset_file::file_stem(name)
        .map_err(sentence)
        .map(|_| stem(path))?;
    let to = preset_file::rename(path, name).map_err(sentence)?;
    state.settings.recents.rename(path, &to);
    let renamed = preset_file::load_with(&to, &state.session.preset_file.effects);
    if let (Some(id), Ok(renamed)) = (open, renamed) {
        refile(state, &id, renamed);
    }
    let after = stem(&to);
    if before != after
        && state
            .files
            .favorites
            .has(super::favorites::Starred::Preset, &before)
    {
        state
            .files
            .favorites
            .change(super::favorites::Starred::Preset, &before, false);
        state
            .files
            .favorites
            .change(super::favorites::Starred::Preset, &after, true);
        write_favorites(state);
    }
    panels.browser.refresh(&state.files.folders, &after);
    Ok(format!("Renamed to {}", name.trim()))
}

/// The preset that was opened from the file at `path` and is open, or was since the start.
fn open_at(state: &State, path: &Path) -> Option<FileId> {
    let absolute = |path: &Path| disk::absolute(path).unwrap_or_else(|_| path.to_owned());
    let is_there = |id: &&FileId| {
        id.path
            .as_deref()
            .is_some_and(|other| absolute(other) == absolute(path))
    };
    state.session.file_ids().find(is_there).cloned()
}

/// Is the file as the open preset knows it? True if another preset is open.
fn is_known(state: &State, id: &FileId) -> bool {
    let open = &state.session.preset_file;
    if FileId::of(open) != *id {
        return true;
    }
    let there = id
        .path
        .as_deref()
        .and_then(|path| preset_file::load_with(path, &open.effects).ok());
    there.is_some_and(|there| there.has_text_of(open))
}

/// A preset that was opened has another file: the session and every step of undo name that one.
fn refile(state: &mut State, before: &FileId, after: PresetFile) {
    state.observe(false);
    refile_history(&mut state.history, before, &after);
    state.session.refile(before, after);
}

fn refile_history(history: &mut History<UndoState>, before: &FileId, after: &PresetFile) {
    history.close();
    history.change_all(|step| {
        if step.file == *before {
            step.file = FileId::of(after);
            step.preset.name.clone_from(&after.preset.name);
        }
    });
}

fn duplicate(
    state: &mut State,
    panels: &mut Panels,
    source: &PresetFile,
) -> Result<String, String> {
    let own = source
        .path
        .as_deref()
        .and_then(Path::parent)
        .map(Path::to_owned);
    let folder = own
        .or_else(|| state.files.folders.presets.clone())
        .or_else(|| state.files.folders.user_presets());
    let folder =
        folder.ok_or("There is no folder for presets; open the window with --presets DIR")?;
    let copy = preset_file::duplicate(source, &folder).map_err(sentence)?;
    panels.browser.refresh(&state.files.folders, &stem(&copy));
    Ok(format!("Duplicated as {}", copy.display()))
}

fn delete(state: &mut State, panels: &mut Panels, path: &Path) -> Result<String, String> {
    let open = open_at(state, path);
    let deleted = Deleted::delete(path)?;
    state.settings.recents.remove(path);
    if let Some(id) = open
        && let Some(mut filed) = state.session.filed(&id).cloned()
    {
        // The window keeps showing it. Save asks for a name.
        filed.path = None;
        refile(state, &id, filed);
    }
    let text = format!("Deleted {}", deleted.name());
    panels
        .browser
        .refresh(&state.files.folders, &deleted.name());
    state.files.deleted.push(deleted);
    Ok(text)
}

fn restore(state: &mut State, panels: &mut Panels) -> Result<String, String> {
    let deleted = state
        .files
        .deleted
        .pop()
        .ok_or("Nothing was deleted since the window opened")?;
    let path = deleted.restore().map_err(sentence)?;
    let id = FileId {
        id: deleted.name(),
        path: None,
    };
    let back = preset_file::load_with(&path, &state.session.preset_file.effects);
    if let (Some(_), Ok(back)) = (state.session.filed(&id), back) {
        refile(state, &id, back);
    }
    panels.browser.refresh(&state.files.folders, &stem(&path));
    Ok(format!("{} is back", path.display()))
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn copy_effect(ctx: &egui::Context, state: &mut State, effect: &Arc<Effect>) {
    let Some(values) = EffectValues::of(state.session.preset(), &effect.name) else {
        return;
    };
    ctx.copy_text(values.to_text(&state.session.preset_file.effects));
    state.notify(
        Level::Info,
        format!(
            "Copied {}; paste it into another preset with Ctrl+V",
            effect.name
        ),
    );
}

/// Pastes an effect with its values as one step of undo.
pub fn paste_effect(state: &mut State, text: &str) {
    let parsed = EffectValues::parse(text, "the clipboard", &state.session.preset_file.effects);
    notify_outcome(state, |state| {
        put(state, &parsed.map_err(sentence)?, "Pasted")
    });
}

/// Enables an effect with `values`, as one step of undo.
fn put(state: &mut State, values: &EffectValues, verb: &str) -> Result<String, String> {
    state.observe(false);
    state.history.close();
    values
        .put_into(state.session.preset_mut())
        .map_err(|conflict| conflict.to_string())?;
    state.observe(false);
    state.history.close();
    Ok(format!("{verb} {}", values.enabled.effect.name))
}

fn save_values(state: &mut State, effect: &Arc<Effect>, name: &str) -> Result<String, String> {
    let folder = state
        .files
        .folders
        .effect_values()
        .ok_or("There is no folder for values of effects")?;
    let values = EffectValues::of(state.session.preset(), &effect.name)
        .ok_or_else(|| format!("{} is not enabled", effect.name))?;
    preset_file::save_values(&values, &state.session.preset_file.effects, name, &folder)
        .map_err(sentence)?;
    state.files.values = preset_file::saved_values(&folder);
    Ok(format!(
        "Saved the values of {} as {}",
        effect.name,
        name.trim()
    ))
}

fn delete_values(state: &mut State, path: &Path) -> Result<String, String> {
    let deleted = Deleted::delete(path)?;
    state.files.values = state
        .files
        .folders
        .effect_values()
        .map_or_else(Vec::new, |folder| preset_file::saved_values(&folder));
    Ok(format!("The values {} are in the trash", deleted.name()))
}
