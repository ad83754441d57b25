//! Carries out commands that edit the preset.

use eframe::egui::{self, ViewportCommand};

use super::{command::KeyframeEdit, session::UndoState};
use crate::app::{
    panels::timeline::Timeline,
    shell::{command::RowCommand, log::Level, state::State},
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
pub fn restore(state: &mut State, to: Option<UndoState>, what: &str) {
    match to.map(|to| state.session.restore(to)) {
        None => state.notify(Level::Info, format!("Nothing to {what}")),
        Some(Some(name)) => state.notify(Level::Info, format!("Back to {name}")),
        Some(None) => {}
    }
}

pub fn keyframe(state: &mut State, timeline: &mut Timeline, edit: KeyframeEdit) {
    match state.session.edit_keyframe(edit) {
        Ok(Some(key)) => timeline.selected = Some(key),
        Ok(None) => {}
        Err(error) => state.notify(Level::Error, error),
    }
}

pub fn row(ctx: &egui::Context, state: &mut State, command: RowCommand) {
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
pub fn set_text(state: &mut State, path: &str, text: &str) {
    match state.session.set_text(path, text) {
        Ok(()) => state.notify(Level::Info, format!("{path} = {text}")),
        Err(error) => state.notify(Level::Error, error),
    }
}
