//! What every panel is.

use egui::{Response, Ui};

use crate::app::shell::{action::Action, command::Commands, state::State};

/// A part of the window. It owns what only it needs, reads the state, and sends commands for
/// everything else.
pub trait Panel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands);
}

/// Performs `action` when `button` is clicked, which says so on hover.
pub fn performs(button: Response, commands: &Commands, action: Action) {
    if button.on_hover_text(action.hint()).clicked() {
        commands.perform(action);
    }
}
