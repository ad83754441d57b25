//! Carrying out commands, a function per subject.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use eframe::egui::{self, ViewportCommand};

use super::{
    anti_aliasing,
    command::{CodeUse, Command, Commands, FileCommand, KeyframeEdit, Manner, Purpose, RowCommand, Side, Toggle, ViewCommand},
    film, library,
    log::Level,
    new_effect, open,
    panels::{Panels, timeline::Timeline},
    reload, reveal,
    screen::Inputs,
    session::UndoState,
    state::State,
};
use crate::preset_file::{self, PresetFile};

/// Carries out the commands that were sent, in order.
pub fn apply_all(ctx: &egui::Context, state: &mut State, panels: &mut Panels, commands: &Commands) {
    for command in commands.take() {
        apply(ctx, state, panels, command);
    }
}

/// Carries out `command`.
fn apply(ctx: &egui::Context, state: &mut State, panels: &mut Panels, command: Command) {
    if command.begins_step() {
        state.history.close();
    }
    match command {
        Command::Perform(action) => apply(ctx, state, panels, action.into()),
        Command::Undo => {
            state.observe(false);
            let before = state.history.undo();
            restore(state, before, "undo");
        }
        Command::Redo => {
            state.observe(false);
            let after = state.history.redo();
            restore(state, after, "redo");
        }
        Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
        Command::Edit(edit) => report(state, |state| state.session.edit(edit)),
        Command::Randomize => match state.session.randomize() {
            Some(seed) => state.notify(Level::Info, format!("Randomized with seed {seed}")),
            None => state.notify(Level::Info, "No effect is enabled, so there is nothing to randomize"),
        },
        Command::VaryBy(percent) => state.session.randomizer.vary_percent = percent.clamp(1.0, 100.0),
        Command::Lock((effect, field), is_locked) => state.session.randomizer.lock(&effect, &field, is_locked),
        Command::RecallSeed(seed) => recall_seed(state, seed),
        Command::SetValues(values) => set_values(state, &values),
        Command::DrawCells(cells) => state.jobs.draw_cells(state.screen.gpu.clone(), cells),
        Command::PinOptions(pins, axes) => {
            let mut accuracy = state.session.preset().accuracy;
            axes.iter().for_each(|axis| accuracy.pins.set(axis, pins.get(axis)));
            state.session.preset_mut().accuracy = accuracy;
            state.observe(false);
            state.history.close();
            let words = pins.words();
            state.notify(Level::Info, if words.is_empty() { "The planner chooses again".into() } else { format!("Switched to {words}") });
        }
        Command::Keyframe(edit) => keyframe(state, &mut panels.timeline, edit),
        Command::RemoveSelectedKey => match panels.timeline.selected.take() {
            Some(key) => keyframe(state, &mut panels.timeline, KeyframeEdit::Remove(key)),
            None => state.notify(Level::Info, "No key is selected. Click one on the timeline first."),
        },
        Command::Time(command) => {
            if let Some(hint) = state.session.change_time(command) {
                state.notify(Level::Info, hint);
            }
        }
        Command::Row(command) => row(ctx, state, command),
        Command::File(command) => file(ctx, state, panels, command),
        Command::View(command) => view(state, panels, command),
        Command::MeasureTrade(request, progress) => {
            if let Some(scene) = state.session.scene() {
                state.jobs.measure(state.screen.gpu.summary.name.clone(), scene.clone(), *request, progress);
            }
        }
        Command::MeasureTiers => state.tier_times.is_looked_at = true,
        Command::ExportFilm(request, progress) => export_film(state, *request, progress),
        Command::Toggle(which) => toggle(state, panels, which),
        Command::Settings(command) => {
            if let Err(refused) = state.settings.change(ctx, command) {
                state.notify(Level::Warning, refused);
            }
        }
        Command::Library(command) => library::library(ctx, state, panels, command),
        Command::Verify => verify(state, panels),
        Command::CancelVerify => state.verification.cancel(),
        Command::CancelLoading => open::cancel_loading(state, panels),
        Command::Mute(effect, true) => drop(state.session.muted.insert(effect.name.clone())),
        Command::Mute(effect, false) => drop(state.session.muted.remove(&effect.name)),
        Command::HoverRow { path, value } => state.clipboard.hovered_row = Some((path, value)),
        Command::CopyPreset => {
            ctx.copy_text(preset_file::to_line(&state.session.preset_file));
            state.notify(Level::Info, "Copied the preset as one line of text");
        }
        Command::Paste => ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
        Command::PasteText(text) => paste(state, panels, &text),
        Command::SetText(path, text) => set_text(state, &path, &text),
        Command::Reveal(path) => {
            state.open.right = true;
            reveal::start(ctx, path);
        }
        Command::ClearLog => state.log.clear(),
        Command::Log(level, text) => state.log.add(level, text),
        Command::Notify(level, text) => state.notify(level, text),
    }
}

/// Notifies of an error of `change`.
fn report(state: &mut State, change: impl FnOnce(&mut State) -> Result<(), String>) {
    if let Err(error) = change(state) {
        state.notify(Level::Error, error);
    }
}

/// Goes back to the values of a seed.
fn recall_seed(state: &mut State, seed: u32) {
    if state.session.recall_seed(seed) {
        state.notify(Level::Info, format!("Back to seed {seed}"));
    }
}

/// Sets values by their paths.
fn set_values(state: &mut State, values: &[(String, String)]) {
    for (path, value) in values {
        if let Err(error) = state.session.set_text(path, value) {
            return state.notify(Level::Error, error);
        }
    }
    let said: Vec<String> = values.iter().map(|(path, value)| format!("{path} = {value}")).collect();
    state.notify(Level::Info, said.join(", "));
}

/// Goes to a state of the history; `what` names the step if there is none.
fn restore(state: &mut State, to: Option<UndoState>, what: &str) {
    match to.map(|to| state.session.restore(to)) {
        None => state.notify(Level::Info, format!("Nothing to {what}")),
        Some(Some(name)) => state.notify(Level::Info, format!("Back to {name}")),
        Some(None) => {}
    }
}

fn keyframe(state: &mut State, timeline: &mut Timeline, edit: KeyframeEdit) {
    match state.session.edit_keyframe(edit) {
        Ok(Some(key)) => timeline.selected = Some(key),
        Ok(None) => {}
        Err(error) => state.notify(Level::Error, error),
    }
}

fn row(ctx: &egui::Context, state: &mut State, command: RowCommand) {
    match command {
        RowCommand::Reset(path) => report(state, |state| state.session.reset(&path)),
        RowCommand::ResetGroup(group) => report(state, |state| state.session.reset_group(&group)),
        RowCommand::ToggleKey(path) => report(state, |state| state.session.toggle_key(&path)),
        RowCommand::Copy(text) => {
            ctx.copy_text(text.clone());
            state.notify(Level::Info, format!("Copied {text}"));
        }
        RowCommand::Paste(path) => {
            state.clipboard.paste_into = Some(path);
            ctx.send_viewport_cmd(ViewportCommand::RequestPaste);
        }
    }
}

/// Gives the value at `path`, and says so.
fn set_text(state: &mut State, path: &str, text: &str) {
    match state.session.set_text(path, text) {
        Ok(()) => state.notify(Level::Info, format!("{path} = {text}")),
        Err(error) => state.notify(Level::Error, error),
    }
}

/// Text from the clipboard: a preset, or a value for a row.
fn paste(state: &mut State, panels: &mut Panels, text: &str) {
    state.history.close();
    let hovered = state.clipboard.hovered_row.as_ref().map(|(path, _)| path.clone());
    let row = state.clipboard.paste_into.take().or(hovered);
    let is_preset = text.trim_start().starts_with("rasterlab1:");
    if preset_file::is_effect_text(text) {
        return library::paste_effect(state, text);
    }
    match row {
        Some(path) if !is_preset => set_text(state, &path, text.trim()),
        _ => match preset_file::from_line(text) {
            Ok(pasted) => request_open(state, panels, pasted, Manner::WithScene, "Pasted a preset".into()),
            Err(error) => state.notify(Level::Error, error.to_string()),
        },
    }
}

fn view(state: &mut State, panels: &mut Panels, command: ViewCommand) {
    match command {
        ViewCommand::ToggleOverlays => state.overlays.toggle(),
        ViewCommand::ShowOverlay(overlay, on) => state.overlays.set(overlay, on),
        ViewCommand::OverlayGain(gain) => state.overlays.gain = gain,
        ViewCommand::CycleCompare => panels.viewport.compare.cycle(),
        ViewCommand::FlipCompare => panels.viewport.compare.flip(),
        ViewCommand::Mark(marker) => state.marker = marker.map(|marker| *marker),
        ViewCommand::Pick(picking) => state.picking = picking,
    }
}

fn toggle(state: &mut State, panels: &mut Panels, which: Toggle) {
    let open = &mut state.open;
    match which {
        Toggle::Panels => {
            let is_any = open.left || open.right || open.timeline;
            (open.left, open.right, open.timeline) = (!is_any, !is_any, !is_any);
        }
        Toggle::Timeline => open.timeline = !open.timeline,
        Toggle::Trade => open.trade = !open.trade,
        Toggle::Timing => open.timing = !open.timing,
        Toggle::Log => open.log = !open.log,
        Toggle::Handles => open.handles = !open.handles,
        Toggle::CheatSheet => open.cheat_sheet = !open.cheat_sheet,
        Toggle::Settings => open.settings = !open.settings,
        Toggle::Palette => panels.palette.toggle(&state.session, panels.browser.entries()),
        Toggle::Extremes => panels.extremes.toggle(),
        Toggle::Randomize => panels.randomize.toggle(),
        Toggle::Sweep => panels.sweep.toggle(),
        Toggle::Film => panels.film.toggle(state),
    }
}

/// Starts the oracle on the picture that is shown, and on the one it is compared with. Nothing while it runs.
fn verify(state: &mut State, panels: &Panels) {
    if state.verification.is_running() {
        return;
    }
    verify_shown(state);
    let compared = panels.viewport.compare.unjudged();
    if let Some(inputs) = compared.filter(|inputs| Some(inputs) != state.screen.requested()) {
        judge(state, inputs);
    }
}

/// Starts the oracle on the picture that is shown.
pub fn verify_shown(state: &mut State) {
    if let Some(inputs) = state.screen.requested().cloned() {
        judge(state, inputs);
    }
}

fn judge(state: &mut State, inputs: Inputs) {
    let work = state.verification.start(inputs.view.pixels() as f64);
    state.jobs.verify(state.screen.gpu.clone(), inputs, work);
}

fn file(ctx: &egui::Context, state: &mut State, panels: &mut Panels, command: FileCommand) {
    match command {
        FileCommand::Ask(purpose) => {
            let output = state.session.preset().output.size;
            let size = state.screen.requested().map_or(output, |inputs| [inputs.view.width, inputs.view.height]);
            panels.dialogs.ask_path(purpose, &state.session, state.folders.presets.as_deref(), size);
        }
        FileCommand::Browse(purpose, path) => state.jobs.ask_path(purpose, &path),
        FileCommand::List(folder) => state.jobs.list_folder(folder),
        FileCommand::Restore(restored) => open::restore(state, panels, *restored),
        FileCommand::ForgetRecents => state.settings.recents.clear(),
        FileCommand::Open(what) if Path::new(&what).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("wgsl")) => {
            reload::add_effect_file(state, Path::new(&what));
        }
        FileCommand::Open(what) => match preset_file::open(&what, &state.folders) {
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
        FileCommand::OpenNeighbor(step) => match panels.browser.neighbor(state.session.preset_file.look_id(), step).cloned() {
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
        FileCommand::AskNewEffect(duplicated) => panels.dialogs.ask_new_effect(duplicated, &state.session.preset_file.effects),
        FileCommand::NewEffect { name, origin } => new_effect::create(state, &name, origin),
        FileCommand::Edit(path) => state.jobs.open_editor(path),
        FileCommand::Resolve { theirs, side, saving } => resolve(state, panels, theirs, side, saving),
        FileCommand::UseCode { preset_file, then, runs } => use_code(state, panels, *preset_file, then, runs),
        FileCommand::Quit { keeps_edits } => {
            (state.may_quit, state.keeps_edits) = (true, keeps_edits);
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
    }
}

fn open_and_notify(state: &mut State, panels: &mut Panels, opened: PresetFile, manner: Manner) {
    let said = format!("Opened {}", opened.title());
    request_open(state, panels, opened, manner, said);
}

/// Opens a preset and says so. Asks first if it brings code that has not been allowed.
fn request_open(state: &mut State, panels: &mut Panels, opened: PresetFile, manner: Manner, said: String) {
    if state.trust.allows(&opened, &state.folders.effects) {
        open::begin(state, panels, opened, manner, said);
    } else {
        panels.dialogs.ask_code(opened.into(), CodeUse::Open(manner, said));
    }
}

/// Goes on with a preset that brings effects: with them if they may run, or without.
fn use_code(state: &mut State, panels: &mut Panels, brings: PresetFile, then: CodeUse, runs: bool) {
    let decided = if runs {
        state.trust.allow(&brings);
        brings
    } else {
        brings.without_brought()
    };
    match then {
        CodeUse::Open(manner, said) => {
            let said = if runs { said } else { format!("{said} without its effects") };
            open::begin(state, panels, decided, manner, said);
        }
        CodeUse::Reload => reload::take_preset(state, panels, decided),
    }
}

/// Carries out the decision between the open preset and what another program has made of its file.
fn resolve(state: &mut State, panels: &mut Panels, theirs: Box<PresetFile>, side: Side, saving: Option<PathBuf>) {
    match side {
        Side::Theirs => return reload::offer_preset(state, panels, theirs),
        Side::Mine => state.live.overruled = Some(theirs),
        Side::Both => reload::merge_preset(state, *theirs),
    }
    if let Some(path) = saving {
        write(state, panels, &path);
    }
}

/// May the open preset be written to `path`? A file that another program has changed is asked about.
fn may_write(state: &mut State, panels: &mut Panels, path: &Path) -> bool {
    let open = &state.session.preset_file;
    if open.path.as_deref() != Some(path) || open.read_only || !path.exists() {
        return true;
    }
    match preset_file::load_with(path, &open.effects) {
        Ok(there) if there.has_text_of(open) || state.live.overruled.as_ref().is_some_and(|known| there.has_text_of(known)) => true,
        Ok(there) => {
            panels.dialogs.ask_changed(there.into(), Some(path.to_owned()));
            false
        }
        Err(error) => {
            let text = format!("{error}. Another program has changed the file, so it was not saved; Save as… keeps both");
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
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty())
        && let Err(error) = std::fs::create_dir_all(folder)
    {
        let reason = format!("{}: the folder cannot be created: {error}", folder.display());
        return save_failed(state, panels, Purpose::SaveAs, path, reason);
    }
    match preset_file::save(&mut state.session.preset_file, path) {
        Ok(()) => {
            let saved = state.session.preset_file.clone();
            state.settings.recents.add_opened(&saved);
            panels.browser.refresh(&state.folders, &saved.id);
            state.session.remember(saved);
            state.notify(Level::Info, format!("Saved {}", path.display()));
        }
        Err(error) => save_failed(state, panels, Purpose::SaveAs, path, error.to_string()),
    }
}

/// Shows the dialog of a save that failed again, with its path and the reason.
pub fn save_failed(state: &mut State, panels: &mut Panels, purpose: Purpose, path: &Path, reason: String) {
    if panels.dialogs.save_failed(purpose, path, &reason) {
        state.log.add(Level::Error, reason);
    } else {
        state.notify(Level::Error, reason);
    }
}

fn export(state: &mut State, path: PathBuf, size: [u32; 2]) {
    let (Some(scene), Some(requested)) = (state.session.scene(), state.screen.requested()) else {
        return state.notify(Level::Error, "There is no picture to export yet");
    };
    let mut exported = state.session.preset_file.clone();
    exported.preset = state.session.shown_preset();
    // The picture has the anti-aliasing that is shown, and its preset pins that.
    exported.preset.accuracy = anti_aliasing::for_export(exported.preset.accuracy, &state.screen.gpu.caps, size);
    let accuracy = state.tier_times.informed(exported.preset.accuracy);
    let inputs = Inputs { view: state.session.view_at(scene, size), accuracy, ..requested.clone() };
    state.jobs.export(state.screen.gpu.clone(), inputs, exported, path);
}

/// Draws a film as the window shows the preset: without muted effects.
fn export_film(state: &State, request: film::Request, progress: Arc<film::Progress>) {
    let Some(scene) = state.session.scene() else { return };
    let mut exported = state.session.preset_file.clone();
    state.session.muted.iter().for_each(|effect| exported.preset.disable(effect));
    state.jobs.export_film(state.screen.gpu.summary.name.clone(), scene.clone(), exported, request, progress);
}
