//! Carries out commands that open and save files.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use egui::ViewportCommand;

use super::{
    command::{CodeUse, Manner, Purpose, Side},
    open, reload,
};
use crate::{
    app::{
        App,
        jobs::film,
        picture::screen::Inputs,
        shell::{log::Level, state::State},
    },
    host::disk,
    preset::SceneSource,
    preset_file::{self, Existing, PresetFile},
};

/// Shows the dialog for this purpose.
pub fn ask_path(app: &mut App, purpose: Purpose) {
    #[cfg(target_arch = "wasm32")]
    if purpose == Purpose::Open {
        return app.state.jobs.ask_files();
    }
    let state = &app.state;
    let requested = state.picture.screen.requested();
    let size = requested.map_or(state.session.preset().output.size, |inputs| {
        [inputs.view.width, inputs.view.height]
    });
    let presets = state.files.folders.presets.as_deref();
    app.panels
        .dialogs
        .ask_path(purpose, &state.session, presets, size);
}

/// Opens a preset, model or picture by path, id or `builtin:QUERY`, or enables the effect of a file.
pub fn open_named(app: &mut App, what: &str) {
    let path = Path::new(what);
    if path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("wgsl"))
    {
        return reload::add_effect_file(app, path);
    }
    match preset_file::open(what, &app.state.files.folders) {
        Ok(opened) => {
            let manner = open::manner_of(what, &opened);
            open_preset(app, opened, manner);
        }
        Err(error) => app.notify(Level::Error, error.to_string()),
    }
}

/// Opens the preset whose look is shown on the user's own scene, with its scene.
pub fn open_with_scene(app: &mut App) {
    match app.state.session.look_file().cloned() {
        Some(look) => open_preset(app, look, Manner::WithScene),
        None => app.notify(Level::Info, "This preset shows its own scene already"),
    }
}

/// Opens the preset this many entries further in the gallery, wrapping round.
pub fn open_neighbor(app: &mut App, step: isize) {
    let id = app.state.session.preset_file.look_id();
    match app.panels.browser.neighbor(id, step).cloned() {
        Some(neighbor) => open_preset(app, neighbor, Manner::Look),
        None => app.notify(Level::Info, "There are no presets to open"),
    }
}

/// Saves to the preset's own file, or asks for one.
pub fn save(app: &mut App) {
    let open = &app.state.session.preset_file;
    match open.path.clone().filter(|_| !open.read_only) {
        Some(path) => save_to(app, path, None),
        None => ask_path(app, Purpose::SaveAs),
    }
}

/// Goes on with a preset that names a model outside of its folder, now that the user has decided
/// whether that is opened, or only the look is used; `said` is said of it.
pub fn use_outside(
    app: &mut App,
    preset_file: PresetFile,
    manner: Manner,
    said: String,
    opens_model: bool,
) {
    if !opens_model {
        return request_allowed(app, preset_file, Manner::Look, said);
    }
    if let Some(model) = &preset_file.outside_model {
        app.state.files.trust.allow_model(model.clone());
    }
    request_open(app, preset_file, manner, said);
}

/// Closes the window without saving; the edits may come back at the next start.
pub fn quit(app: &mut App, keeps_edits: bool) {
    let closing = &mut app.state.closing;
    (closing.may_quit, closing.keeps_edits) = (true, keeps_edits);
    app.ctx.send_viewport_cmd(ViewportCommand::Close);
}

/// Opens a preset and says so.
pub fn open_preset(app: &mut App, opened: PresetFile, manner: Manner) {
    let said = format!("Opened {}", opened.title());
    request_open(app, opened, manner, said);
}

/// Opens a preset and says so. Asks first if it names a model outside of its folder which the user
/// has neither opened nor allowed, and if it brings code that has not been allowed.
pub fn request_open(app: &mut App, opened: PresetFile, manner: Manner, said: String) {
    match &opened.outside_model {
        Some(model) if !is_known_model(&app.state, model) => {
            app.panels.dialogs.ask_outside(opened.into(), manner, said);
        }
        _ => request_allowed(app, opened.with_outside_model(), manner, said),
    }
}

/// Has the user opened this model, or allowed it?
fn is_known_model(state: &State, model: &Path) -> bool {
    let is_this = |path: &Path| preset_file::normalized(path).as_deref() == Some(model);
    let session = &state.session;
    state.files.trust.allows_model(model)
        || state.settings.recents.iter().any(is_this)
        || session
            .file_ids()
            .filter_map(|id| session.filed(id))
            .any(|filed| matches!(filed.scene_source(), SceneSource::File(path) if is_this(&path)))
}

/// [`request_open`] for a preset whose model was decided about.
fn request_allowed(app: &mut App, opened: PresetFile, manner: Manner, said: String) {
    if app
        .state
        .files
        .trust
        .allows(&opened, &app.state.files.folders.effects)
    {
        open::begin(app, opened, manner, said);
    } else {
        app.panels
            .dialogs
            .ask_code(opened.into(), CodeUse::Open(manner, said));
    }
}

/// Goes on with a preset that brings effects: with them if they may run, or without.
pub fn use_code(app: &mut App, brings: PresetFile, then: CodeUse, runs: bool) {
    let decided = if runs {
        app.state.files.trust.allow(&brings);
        brings
    } else {
        brings.without_brought()
    };
    match then {
        CodeUse::Open(manner, said) => {
            let said = if runs {
                said
            } else {
                format!("{said} without its effects")
            };
            open::begin(app, decided, manner, said);
        }
        CodeUse::Reload => reload::take_preset(app, decided),
    }
}

/// Decides between the open preset and what another program has made of its file. The outcome is
/// saved to `saving`, if that led to the question.
pub fn resolve(app: &mut App, theirs: Box<PresetFile>, side: Side, saving: Option<PathBuf>) {
    match side {
        Side::Theirs => return reload::offer_preset(app, theirs),
        Side::Mine => app.state.files.live.overruled = Some(theirs),
        Side::Both => reload::merge_preset(&mut app.state, *theirs),
    }
    if let Some(path) = saving {
        write(app, &path, None);
    }
}

/// May the open preset be written to `path`? A file that another program has changed is asked
/// about.
fn may_write(app: &mut App, path: &Path) -> bool {
    let open = &app.state.session.preset_file;
    if open.path.as_deref() != Some(path) || open.read_only || !disk::exists(path) {
        return true;
    }
    match preset_file::load_with(path, &open.effects) {
        Ok(there)
            if there.has_text_of(open)
                || app
                    .state
                    .files
                    .live
                    .overruled
                    .as_ref()
                    .is_some_and(|known| there.has_text_of(known)) =>
        {
            true
        }
        Ok(there) => {
            app.panels
                .dialogs
                .ask_changed(there.into(), Some(path.to_owned()));
            false
        }
        Err(error) => {
            let text = format!(
                "{error}. Another program has changed the file, so it was not saved; Save as… keeps both"
            );
            app.notify(Level::Error, text);
            false
        }
    }
}

/// Saves there; asks first if effects are muted. A preset that gets another file gets this name, or
/// that of the file.
pub fn save_to(app: &mut App, path: PathBuf, name: Option<String>) {
    if app.state.session.muted.is_empty() {
        write(app, &path, name);
    } else {
        app.panels.dialogs.ask_muted(path, name);
    }
}

/// Makes the folder that a typed path names, if it is not there.
///
/// # Errors
/// It cannot be made: why, in one sentence.
pub fn make_folder_of(path: &Path) -> Result<(), String> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder.map_or(Ok(()), |folder| {
        disk::create_folder(folder).map_err(|error| {
            format!(
                "{}: the folder cannot be created: {error}",
                folder.display()
            )
        })
    })
}

/// Saves there, with muted effects.
pub fn write(app: &mut App, path: &Path, name: Option<String>) {
    if !may_write(app, path) {
        return;
    }
    if let Err(reason) = make_folder_of(path) {
        return save_failed(app, Purpose::SaveAs, path, reason);
    }
    let mut saved = app.state.session.preset_file.clone();
    if saved.path.as_deref() != Some(path) {
        saved.make_new(name.as_deref(), path);
    }
    match preset_file::save(&mut saved, path) {
        Ok(()) => {
            if let Err(error) = keep_effects(&app.state, &saved, path) {
                app.notify(Level::Warning, error);
            }
            app.state.session.preset_file = saved.clone();
            app.state.settings.recents.add_opened(&saved);
            app.panels
                .browser
                .refresh(&app.state.files.folders, &saved.id);
            app.state.session.remember(saved);
            app.notify(Level::Info, format!("Saved {}", path.display()));
        }
        Err(error) => save_failed(app, Purpose::SaveAs, path, error.to_string()),
    }
}

/// Copies the effects of files that nobody would find from `path` into the folder `effects` beside
/// it.
///
/// # Errors
/// One of them cannot be written: why, in one sentence.
fn keep_effects(state: &State, saved: &PresetFile, path: &Path) -> Result<(), String> {
    let beside = path.with_file_name("effects");
    for source in saved
        .preset
        .stack
        .0
        .iter()
        .filter_map(|enabled| enabled.effect.source.as_ref())
    {
        let mut custom = saved.effects.custom();
        let file = custom
            .find(|(name, _)| *name == source.stem)
            .and_then(|(_, found)| found.path.clone());
        let folder = file.as_deref().and_then(Path::parent);
        let copy = beside.join(format!("{}.wgsl", source.stem));
        let is_found = folder.is_none_or(|folder| {
            folder == beside
                || state
                    .files
                    .folders
                    .effect_folders
                    .iter()
                    .any(|own| own == folder)
        });
        if is_found || copy.exists() {
            continue;
        }
        make_folder_of(&copy)?;
        preset_file::write_atomically(&copy, source.shared().as_bytes(), Existing::Keep)
            .map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Shows the dialog of a save that failed again, with its path and the reason.
pub fn save_failed(app: &mut App, purpose: Purpose, path: &Path, reason: String) {
    if app.panels.dialogs.save_failed(purpose, path, &reason) {
        app.state.log.add(Level::Error, reason);
    } else {
        app.notify(Level::Error, reason);
    }
}

/// Draws the picture at this size and saves it as a PNG.
pub fn export(app: &mut App, path: PathBuf, size: [u32; 2]) {
    if let Err(reason) = make_folder_of(&path) {
        return save_failed(app, Purpose::Export, &path, reason);
    }
    let (Some(scene), Some(requested)) = (
        app.state.session.scene(),
        app.state.picture.screen.requested(),
    ) else {
        return app.notify(Level::Error, "There is no picture to export yet");
    };
    let mut exported = app.state.session.preset_file.clone();
    exported.preset = app.state.session.shown_preset();
    // The preset in the picture pins the anti-aliasing.
    exported.preset.accuracy = exported.preset.accuracy.anti_aliased();
    let accuracy = app
        .state
        .picture
        .tier_times
        .informed(exported.preset.accuracy);
    let inputs = Inputs {
        view: app.state.session.view_at(scene, size),
        stack: app.state.session.visible_stack().drawn(
            app.state
                .session
                .length_scale(app.state.session.preset(), size),
        ),
        accuracy,
        ..requested.clone()
    };
    app.state
        .jobs
        .export(app.state.picture.screen.gpu.clone(), inputs, exported, path);
}

/// Saves the pictures of the sweep as one.
pub fn save_sheet(app: &mut App, path: PathBuf) {
    let Some(sheet) = app.panels.sweep.sheet(&app.state.session.preset_file.id) else {
        return app.notify(Level::Error, "There is no sheet to save yet");
    };
    let saved = make_folder_of(&path).and_then(|()| {
        let png = preset_file::png_bytes(sheet.color(), sheet.size());
        let png = png.map_err(|error| error.to_string())?;
        // The dialog has asked before it replaces a file.
        preset_file::write_atomically(&path, &png, Existing::Replace)
            .map_err(|error| error.to_string())
    });
    match saved {
        Ok(()) => app.notify(Level::Info, format!("Saved {}", path.display())),
        Err(reason) => save_failed(app, Purpose::Sheet, &path, reason),
    }
}

/// Draws a film as the window shows the preset: without muted effects.
pub fn export_film(app: &mut App, request: film::Request, progress: Arc<film::Progress>) {
    // A folder that cannot be made is named by what is written into it.
    drop(make_folder_of(&request.path));
    let Some(scene) = app.state.session.scene() else {
        return;
    };
    let mut exported = app.state.session.preset_file.clone();
    app.state
        .session
        .muted
        .iter()
        .for_each(|effect| exported.preset.disable(effect));
    app.state.jobs.export_film(
        app.state.picture.screen.gpu.clone(),
        scene.clone(),
        exported,
        request,
        progress,
    );
}
