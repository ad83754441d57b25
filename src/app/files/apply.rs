//! Carries out commands that open and save files.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use eframe::egui::{self, ViewportCommand};

use super::{
    command::{CodeUse, FileCommand, Manner, Purpose, Side},
    open, reload,
};
use crate::{
    app::{
        editing::new_effect,
        jobs::film,
        panels::Panels,
        picture::screen::Inputs,
        shell::{log::Level, state::State},
    },
    host::disk,
    preset::SceneSource,
    preset_file::{self, Existing, PresetFile},
};

pub fn file(ctx: &egui::Context, state: &mut State, panels: &mut Panels, command: FileCommand) {
    match command {
        #[cfg(target_arch = "wasm32")]
        FileCommand::Ask(Purpose::Open) => state.jobs.ask_files(),
        FileCommand::Ask(purpose) => {
            let output = state.session.preset().output.size;
            let size = state
                .picture
                .screen
                .requested()
                .map_or(output, |inputs| [inputs.view.width, inputs.view.height]);
            panels.dialogs.ask_path(
                purpose,
                &state.session,
                state.files.folders.presets.as_deref(),
                size,
            );
        }
        FileCommand::Browse(purpose, path) => state.jobs.ask_path(purpose, &path),
        FileCommand::List(folder) => state.jobs.list_folder(folder),
        FileCommand::Restore(restored) => open::restore(state, panels, *restored),
        FileCommand::ForgetRecents => state.settings.recents.clear(),
        FileCommand::Open(what)
            if Path::new(&what)
                .extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case("wgsl")) =>
        {
            reload::add_effect_file(state, panels, Path::new(&what));
        }
        FileCommand::Open(what) => match preset_file::open(&what, &state.files.folders) {
            Ok(opened) => {
                let manner = open::manner_of(&what, &opened);
                open_and_notify(state, panels, opened, manner);
            }
            Err(error) => state.notify(Level::Error, error.to_string()),
        },
        FileCommand::OpenPreset(opened, manner) => open_and_notify(state, panels, *opened, manner),
        FileCommand::OpenWithScene => match state.session.look_file().cloned() {
            Some(look) => open_and_notify(state, panels, look, Manner::WithScene),
            None => state.notify(Level::Info, "This preset shows its own scene already"),
        },
        FileCommand::OpenNeighbor(step) => match panels
            .browser
            .neighbor(state.session.preset_file.look_id(), step)
            .cloned()
        {
            Some(neighbor) => open_and_notify(state, panels, neighbor, Manner::Look),
            None => state.notify(Level::Info, "There are no presets to open"),
        },
        FileCommand::Save => {
            let open = &state.session.preset_file;
            match open.path.clone().filter(|_| !open.read_only) {
                Some(path) => save_to(state, panels, path, None),
                None => file(ctx, state, panels, FileCommand::Ask(Purpose::SaveAs)),
            }
        }
        FileCommand::SaveTo { path, name } => save_to(state, panels, path, name),
        FileCommand::Write {
            path,
            name,
            drops_muted,
        } => {
            if drops_muted {
                state.session.drop_muted();
            }
            write(state, panels, &path, name);
        }
        FileCommand::Export { path, size } => export(state, panels, path, size),
        #[cfg(target_arch = "wasm32")]
        FileCommand::ExportAll => super::take_along::export(state),
        #[cfg(not(target_arch = "wasm32"))]
        FileCommand::ExportAll => {}
        FileCommand::AskNewEffect(duplicated) => panels
            .dialogs
            .ask_new_effect(duplicated, &state.session.preset_file.effects),
        FileCommand::NewEffect { name, origin } => new_effect::create(state, &name, origin),
        FileCommand::Edit(path) => state.jobs.open_editor(path),
        FileCommand::ShowCode(path) => state.jobs.read_code(path),
        FileCommand::TryCode { path, text } => state.jobs.try_code(path, text),
        FileCommand::SaveCode { path, text } => state.jobs.save_code(path, text),
        FileCommand::Resolve {
            theirs,
            side,
            saving,
        } => resolve(state, panels, theirs, side, saving),
        FileCommand::UseCode {
            preset_file,
            then,
            runs,
        } => use_code(state, panels, *preset_file, then, runs),
        FileCommand::UseOutside {
            preset_file,
            manner,
            said,
            opens_model: true,
        } => {
            if let Some(model) = &preset_file.outside_model {
                state.files.trust.allow_model(model.clone());
            }
            request_open(state, panels, *preset_file, manner, said);
        }
        FileCommand::UseOutside {
            preset_file, said, ..
        } => request_allowed(state, panels, *preset_file, Manner::Look, said),
        FileCommand::Quit { keeps_edits } => {
            (state.closing.may_quit, state.closing.keeps_edits) = (true, keeps_edits);
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
    }
}

fn open_and_notify(state: &mut State, panels: &mut Panels, opened: PresetFile, manner: Manner) {
    let said = format!("Opened {}", opened.title());
    request_open(state, panels, opened, manner, said);
}

/// Opens a preset and says so. Asks first if it names a model outside of its folder which the user
/// has neither opened nor allowed, and if it brings code that has not been allowed.
pub fn request_open(
    state: &mut State,
    panels: &mut Panels,
    opened: PresetFile,
    manner: Manner,
    said: String,
) {
    match &opened.outside_model {
        Some(model) if !is_known_model(state, model) => {
            panels.dialogs.ask_outside(opened.into(), manner, said);
        }
        _ => request_allowed(state, panels, opened.with_outside_model(), manner, said),
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
fn request_allowed(
    state: &mut State,
    panels: &mut Panels,
    opened: PresetFile,
    manner: Manner,
    said: String,
) {
    if state
        .files
        .trust
        .allows(&opened, &state.files.folders.effects)
    {
        open::begin(state, panels, opened, manner, said);
    } else {
        panels
            .dialogs
            .ask_code(opened.into(), CodeUse::Open(manner, said));
    }
}

/// Goes on with a preset that brings effects: with them if they may run, or without.
fn use_code(state: &mut State, panels: &mut Panels, brings: PresetFile, then: CodeUse, runs: bool) {
    let decided = if runs {
        state.files.trust.allow(&brings);
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
            open::begin(state, panels, decided, manner, said);
        }
        CodeUse::Reload => reload::take_preset(state, panels, decided),
    }
}

/// Carries out the decision between the open preset and what another program has made of its file.
fn resolve(
    state: &mut State,
    panels: &mut Panels,
    theirs: Box<PresetFile>,
    side: Side,
    saving: Option<PathBuf>,
) {
    match side {
        Side::Theirs => return reload::offer_preset(state, panels, theirs),
        Side::Mine => state.files.live.overruled = Some(theirs),
        Side::Both => reload::merge_preset(state, *theirs),
    }
    if let Some(path) = saving {
        write(state, panels, &path, None);
    }
}

/// May the open preset be written to `path`? A file that another program has changed is asked
/// about.
fn may_write(state: &mut State, panels: &mut Panels, path: &Path) -> bool {
    let open = &state.session.preset_file;
    if open.path.as_deref() != Some(path) || open.read_only || !disk::exists(path) {
        return true;
    }
    match preset_file::load_with(path, &open.effects) {
        Ok(there)
            if there.has_text_of(open)
                || state
                    .files
                    .live
                    .overruled
                    .as_ref()
                    .is_some_and(|known| there.has_text_of(known)) =>
        {
            true
        }
        Ok(there) => {
            panels
                .dialogs
                .ask_changed(there.into(), Some(path.to_owned()));
            false
        }
        Err(error) => {
            let text = format!(
                "{error}. Another program has changed the file, so it was not saved; Save as… keeps both"
            );
            state.notify(Level::Error, text);
            false
        }
    }
}

/// Saves there; asks first if effects are muted.
fn save_to(state: &mut State, panels: &mut Panels, path: PathBuf, name: Option<String>) {
    if state.session.muted.is_empty() {
        write(state, panels, &path, name);
    } else {
        panels.dialogs.ask_muted(path, name);
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

fn write(state: &mut State, panels: &mut Panels, path: &Path, name: Option<String>) {
    if !may_write(state, panels, path) {
        return;
    }
    if let Err(reason) = make_folder_of(path) {
        return save_failed(state, panels, Purpose::SaveAs, path, reason);
    }
    let mut saved = state.session.preset_file.clone();
    if saved.path.as_deref() != Some(path) {
        saved.make_new(name.as_deref(), path);
    }
    match preset_file::save(&mut saved, path) {
        Ok(()) => {
            if let Err(error) = keep_effects(state, &saved, path) {
                state.notify(Level::Warning, error);
            }
            state.session.preset_file = saved.clone();
            state.settings.recents.add_opened(&saved);
            panels.browser.refresh(&state.files.folders, &saved.id);
            state.session.remember(saved);
            state.notify(Level::Info, format!("Saved {}", path.display()));
        }
        Err(error) => save_failed(state, panels, Purpose::SaveAs, path, error.to_string()),
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
pub fn save_failed(
    state: &mut State,
    panels: &mut Panels,
    purpose: Purpose,
    path: &Path,
    reason: String,
) {
    if panels.dialogs.save_failed(purpose, path, &reason) {
        state.log.add(Level::Error, reason);
    } else {
        state.notify(Level::Error, reason);
    }
}

pub fn export(state: &mut State, panels: &mut Panels, path: PathBuf, size: [u32; 2]) {
    if let Err(reason) = make_folder_of(&path) {
        return save_failed(state, panels, Purpose::Export, &path, reason);
    }
    let (Some(scene), Some(requested)) = (state.session.scene(), state.picture.screen.requested())
    else {
        return state.notify(Level::Error, "There is no picture to export yet");
    };
    let mut exported = state.session.preset_file.clone();
    exported.preset = state.session.shown_preset();
    // The preset in the picture pins the anti-aliasing.
    exported.preset.accuracy = exported.preset.accuracy.anti_aliased();
    let accuracy = state.picture.tier_times.informed(exported.preset.accuracy);
    let inputs = Inputs {
        view: state.session.view_at(scene, size),
        stack: state
            .session
            .visible_stack()
            .drawn(state.session.length_scale(state.session.preset(), size)),
        accuracy,
        ..requested.clone()
    };
    state
        .jobs
        .export(state.picture.screen.gpu.clone(), inputs, exported, path);
}

/// Draws a film as the window shows the preset: without muted effects.
pub fn export_film(state: &State, request: film::Request, progress: Arc<film::Progress>) {
    // A folder that cannot be made is named by what is written into it.
    drop(make_folder_of(&request.path));
    let Some(scene) = state.session.scene() else {
        return;
    };
    let mut exported = state.session.preset_file.clone();
    state
        .session
        .muted
        .iter()
        .for_each(|effect| exported.preset.disable(effect));
    state.jobs.export_film(
        state.picture.screen.gpu.clone(),
        scene.clone(),
        exported,
        request,
        progress,
    );
}
