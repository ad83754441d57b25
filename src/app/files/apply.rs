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
    preset_file::{self, PresetFile},
};

pub fn file(ctx: &egui::Context, state: &mut State, panels: &mut Panels, command: FileCommand) {
    match command {
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
            reload::add_effect_file(state, Path::new(&what));
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
                Some(path) => save_to(state, panels, path),
                None => file(ctx, state, panels, FileCommand::Ask(Purpose::SaveAs)),
            }
        }
        FileCommand::SaveTo(path) => save_to(state, panels, path),
        FileCommand::Write { path, drops_muted } => {
            if drops_muted {
                state.session.drop_muted();
            }
            write(state, panels, &path);
        }
        FileCommand::Export { path, size } => export(state, path, size),
        FileCommand::AskNewEffect(duplicated) => panels
            .dialogs
            .ask_new_effect(duplicated, &state.session.preset_file.effects),
        FileCommand::NewEffect { name, origin } => new_effect::create(state, &name, origin),
        FileCommand::Edit(path) => state.jobs.open_editor(path),
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

/// Opens a preset and says so. Asks first if it brings code that has not been allowed.
pub fn request_open(
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
        write(state, panels, &path);
    }
}

/// May the open preset be written to `path`? A file that another program has changed is asked
/// about.
fn may_write(state: &mut State, panels: &mut Panels, path: &Path) -> bool {
    let open = &state.session.preset_file;
    if open.path.as_deref() != Some(path) || open.read_only || !path.exists() {
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
fn save_to(state: &mut State, panels: &mut Panels, path: PathBuf) {
    if state.session.muted.is_empty() {
        write(state, panels, &path);
    } else {
        panels.dialogs.ask_muted(path);
    }
}

fn write(state: &mut State, panels: &mut Panels, path: &Path) {
    if !may_write(state, panels, path) {
        return;
    }
    if let Some(folder) = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        && let Err(error) = std::fs::create_dir_all(folder)
    {
        let reason = format!(
            "{}: the folder cannot be created: {error}",
            folder.display()
        );
        return save_failed(state, panels, Purpose::SaveAs, path, reason);
    }
    match preset_file::save(&mut state.session.preset_file, path) {
        Ok(()) => {
            let saved = state.session.preset_file.clone();
            state.settings.recents.add_opened(&saved);
            panels.browser.refresh(&state.files.folders, &saved.id);
            state.session.remember(saved);
            state.notify(Level::Info, format!("Saved {}", path.display()));
        }
        Err(error) => save_failed(state, panels, Purpose::SaveAs, path, error.to_string()),
    }
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

pub fn export(state: &mut State, path: PathBuf, size: [u32; 2]) {
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
        state.picture.screen.gpu.summary.name.clone(),
        scene.clone(),
        exported,
        request,
        progress,
    );
}
