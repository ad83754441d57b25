//! Carries out commands that edit the preset.

use egui::ViewportCommand;

use super::{command::KeyframeEdit, session::UndoState};
use crate::{
    accuracy::{Axis, PinnedOptions},
    app::{
        App,
        shell::{command::RowCommand, log::Level, state::State},
    },
};

/// Notifies of an error of `change`.
pub fn report(state: &mut State, change: impl FnOnce(&mut State) -> Result<(), String>) {
    if let Err(error) = change(state) {
        state.notify(Level::Error, error);
    }
}

/// Goes back to the values of a seed.
pub fn recall_seed(state: &mut State, seed: u32) {
    if state.session.recall_seed(seed) {
        state.notify(Level::Info, format!("Back to seed {seed}"));
    }
}

/// Sets values by their paths.
pub fn set_values(state: &mut State, values: &[(String, String)]) {
    for (path, value) in values {
        if let Err(error) = state.session.set_text(path, value) {
            return state.notify(Level::Error, error);
        }
    }
    let said: Vec<String> = values
        .iter()
        .map(|(path, value)| format!("{path} = {value}"))
        .collect();
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

/// Changes keyframes, and selects the one that is changed.
pub fn keyframe(app: &mut App, edit: KeyframeEdit) {
    match app.state.session.edit_keyframe(edit) {
        Ok(Some(key)) => app.panels.timeline.selected = Some(key),
        Ok(None) => {}
        Err(error) => app.notify(Level::Error, error),
    }
}

/// Removes the keyframe that is selected on the timeline.
pub fn remove_selected_key(app: &mut App) {
    match app.panels.timeline.selected.take() {
        Some(key) => keyframe(app, KeyframeEdit::Remove(key)),
        None => app.notify(
            Level::Info,
            "No key is selected. Click one on the timeline first.",
        ),
    }
}

/// Does what a row of the inspector does besides changing its value.
pub fn row(app: &mut App, command: RowCommand) {
    let state = &mut app.state;
    match command {
        RowCommand::Reset(path) => report(state, |state| state.session.reset(&path)),
        RowCommand::ResetGroup(group) => report(state, |state| state.session.reset_group(&group)),
        RowCommand::ToggleKey(path) => report(state, |state| state.session.toggle_key(&path)),
        RowCommand::Copy(text) => {
            app.ctx.copy_text(text.clone());
            state.notify(Level::Info, format!("Copied {text}"));
        }
        RowCommand::Paste(path) => {
            state.clipboard.paste_into = Some(path);
            app.ctx.send_viewport_cmd(ViewportCommand::RequestPaste);
        }
    }
}

/// Takes the last step back.
pub fn undo(state: &mut State) {
    state.observe(false);
    let before = state.history.undo();
    restore(state, before, "undo");
}

/// Does the step again that was taken back last.
pub fn redo(state: &mut State) {
    state.observe(false);
    let after = state.history.redo();
    restore(state, after, "redo");
}

/// Gives every parameter of the enabled effects that is not locked a random value.
pub fn randomize(state: &mut State) {
    let text = match state.session.randomize() {
        Some(seed) => format!("Randomized with seed {seed}"),
        None => "No effect is enabled, so there is nothing to randomize".into(),
    };
    state.notify(Level::Info, text);
}

/// Pins the options of these axes.
pub fn pin_options(state: &mut State, pins: &PinnedOptions, axes: &[&'static Axis]) {
    let mut accuracy = state.session.preset().accuracy;
    axes.iter()
        .for_each(|axis| accuracy.pins.set(axis, pins.get(axis)));
    state.session.preset_mut().accuracy = accuracy;
    state.observe(false);
    state.history.close();
    let words = pins.words();
    let text = match words.is_empty() {
        true => "The planner chooses again".into(),
        false => format!("Switched to {words}"),
    };
    state.notify(Level::Info, text);
}

/// Plays or pauses; says why if nothing moves.
pub fn play_or_pause(state: &mut State) {
    let session = &mut state.session;
    session.playback.toggle(&session.preset_file.preset.clock);
    if session.playback.playing && !session.preset().is_moving() {
        state.notify(
            Level::Info,
            "Nothing in this preset moves. Set keys for a value at two times, or give the scene a spin.",
        );
    }
}

/// Gives the value at `path`, and says so.
pub fn set_text(state: &mut State, path: &str, text: &str) {
    match state.session.set_text(path, text) {
        Ok(()) => state.notify(Level::Info, format!("{path} = {text}")),
        Err(error) => state.notify(Level::Error, error),
    }
}
