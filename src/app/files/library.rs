//! The user's library: favorites, files of presets, and values of effects.

use std::{path::Path, sync::Arc};

use super::{command::Naming, deleted::Deleted, favorites::Starred};
use crate::{
    app::{
        App,
        editing::{
            history::History,
            session::{FileId, UndoState},
        },
        shell::{command::Edit, log::Level, state::State},
    },
    effects::Effect,
    host::disk,
    preset_file::{self, EffectValues, PresetError, PresetFile},
};

/// Makes the preset of this id, or the effect of this name, a favorite, or takes its star away.
pub fn star(app: &mut App, kind: Starred, name: &str, is_on: bool) {
    app.state.files.favorites.change(kind, name, is_on);
    write_favorites(&mut app.state);
}

/// Uses the name that was asked for.
pub fn use_name(app: &mut App, naming: Naming, name: String) {
    let name = name.trim().to_owned();
    let outcome = match &naming {
        Naming::Preset { path, .. } => rename(app, path, &name),
        Naming::Values(effect) => save_values(&mut app.state, effect, &name),
        Naming::Bookmark(from) => {
            let edit = Edit::RenameBookmark(from.clone(), name.clone());
            let renamed = app.state.session.edit(edit);
            renamed.map(|()| format!("Renamed to {name}"))
        }
    };
    match outcome {
        Ok(text) => app.notify(Level::Info, text),
        Err(error) => app.panels.naming.refuse(naming, name, error),
    }
}

/// Gives an effect the values of a file.
pub fn use_values(app: &mut App, path: &Path) {
    let loaded = preset_file::load_values(path, &app.state.session.preset_file.effects);
    notify_outcome(app, |app| {
        put(
            &mut app.state,
            &loaded.map_err(sentence)?,
            "Took the values of",
        )
    });
}

/// Says what was done, or why it was not.
pub fn notify_outcome(app: &mut App, change: impl FnOnce(&mut App) -> Result<String, String>) {
    match change(app) {
        Ok(text) => app.notify(Level::Info, text),
        Err(error) => app.notify(Level::Error, error),
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

/// Gives the file of a preset another name.
fn rename(app: &mut App, path: &Path, name: &str) -> Result<String, String> {
    let open = open_at(&app.state, path);
    if open.as_ref().is_some_and(|id| !is_known(&app.state, id)) {
        return Err(format!(
            "Another program has changed {}. Save or reload it, then rename it",
            path.display()
        ));
    }
    let before = preset_file::file_stem(name)
        .map_err(sentence)
        .map(|_| stem(path))?;
    let to = preset_file::rename(path, name).map_err(sentence)?;
    app.state.settings.recents.rename(path, &to);
    let renamed = preset_file::load_with(&to, &app.state.session.preset_file.effects);
    if let (Some(id), Ok(renamed)) = (open, renamed) {
        refile(&mut app.state, &id, renamed);
    }
    let after = stem(&to);
    if before != after && app.state.files.favorites.has(Starred::Preset, &before) {
        app.state
            .files
            .favorites
            .change(Starred::Preset, &before, false);
        app.state
            .files
            .favorites
            .change(Starred::Preset, &after, true);
        write_favorites(&mut app.state);
    }
    app.panels.browser.refresh(&app.state.files.folders, &after);
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

/// Writes a copy of the preset, as its file has it.
pub fn duplicate(app: &mut App, source: &PresetFile) -> Result<String, String> {
    let own = source
        .path
        .as_deref()
        .and_then(Path::parent)
        .map(Path::to_owned);
    let folder = own
        .or_else(|| app.state.files.folders.presets.clone())
        .or_else(|| app.state.files.folders.user_presets());
    let folder =
        folder.ok_or("There is no folder for presets; open the window with --presets DIR")?;
    let copy = preset_file::duplicate(source, &folder).map_err(sentence)?;
    app.panels
        .browser
        .refresh(&app.state.files.folders, &stem(&copy));
    Ok(format!("Duplicated as {}", copy.display()))
}

/// Moves the preset at this path to the trash.
pub fn delete(app: &mut App, path: &Path) -> Result<String, String> {
    let open = open_at(&app.state, path);
    let deleted = Deleted::delete(path)?;
    app.state.settings.recents.remove(path);
    if let Some(id) = open
        && let Some(mut filed) = app.state.session.filed(&id).cloned()
    {
        // The window keeps showing it. Save asks for a name.
        filed.path = None;
        refile(&mut app.state, &id, filed);
    }
    let text = format!("Deleted {}", deleted.name());
    app.panels
        .browser
        .refresh(&app.state.files.folders, &deleted.name());
    app.state.files.deleted.push(deleted);
    Ok(text)
}

/// Puts the preset that was deleted last back.
pub fn restore(app: &mut App) -> Result<String, String> {
    let deleted = app
        .state
        .files
        .deleted
        .pop()
        .ok_or("Nothing was deleted since the window opened")?;
    let path = deleted.restore().map_err(sentence)?;
    let id = FileId {
        id: deleted.name(),
        path: None,
    };
    let back = preset_file::load_with(&path, &app.state.session.preset_file.effects);
    if let (Some(_), Ok(back)) = (app.state.session.filed(&id), back) {
        refile(&mut app.state, &id, back);
    }
    app.panels
        .browser
        .refresh(&app.state.files.folders, &stem(&path));
    Ok(format!("{} is back", path.display()))
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// Puts the effect with its values on the clipboard.
pub fn copy_effect(app: &mut App, effect: &Effect) {
    let App { state, ctx, .. } = app;
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
pub fn paste_effect(app: &mut App, text: &str) {
    let effects = &app.state.session.preset_file.effects;
    let parsed = EffectValues::parse(text, "the clipboard", effects);
    notify_outcome(app, |app| {
        put(&mut app.state, &parsed.map_err(sentence)?, "Pasted")
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

/// Moves a file of values to the trash.
pub fn delete_values(app: &mut App, path: &Path) {
    notify_outcome(app, |app| trash_values(&mut app.state, path));
}

fn trash_values(state: &mut State, path: &Path) -> Result<String, String> {
    let deleted = Deleted::delete(path)?;
    state.files.values = state
        .files
        .folders
        .effect_values()
        .map_or_else(Vec::new, |folder| preset_file::saved_values(&folder));
    Ok(format!("The values {} are in the trash", deleted.name()))
}
