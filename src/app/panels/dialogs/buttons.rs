//! The buttons of dialogs.

use eframe::egui::{self, Ui};

use crate::app::{files::command::Side, widgets::theme};

/// The buttons of all dialogs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    Cancel,
    Accept,
    Browse,
    KeepMuted,
    DropMuted,
    Save,
    /// Quit and bring the edits back at the next start.
    Keep,
    Discard,
    Restore,
    Side(Side),
    Run,
    OpenWithout,
    /// Opens a model outside of the folder of what names it.
    OpenModel,
    LookOnly,
}

/// Buttons from right to left, the main one emphasized; `left` adds one at the other end.
pub fn buttons(
    ui: &mut Ui,
    options: &[(&str, Choice, bool)],
    left: impl FnOnce(&mut Ui) -> Option<Choice>,
) -> Option<Choice> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        chosen = left(ui);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            for (text, choice, is_main) in options {
                let button = if *is_main {
                    egui::Button::new(*text).fill(theme::accent_ground())
                } else {
                    egui::Button::new(*text)
                };
                if ui
                    .add(button.min_size(egui::vec2(72.0, theme::ROW)))
                    .clicked()
                {
                    chosen = Some(*choice);
                }
            }
        });
    });
    chosen
}
