//! What every panel has in common.

use eframe::egui::Ui;

use crate::app::shell::{command::Commands, state::State};

/// A part of the window. It owns what only it needs, reads the state, and sends commands for
/// everything else.
pub trait Panel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands);
}
