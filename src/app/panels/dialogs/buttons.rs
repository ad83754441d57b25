//! The buttons of dialogs.

use egui::{self, Ui, vec2};

use crate::app::{
    files::command::Side,
    widgets::{
        panel::{at_right, main_button},
        theme,
    },
};

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
pub fn buttons<C: Copy>(
    ui: &mut Ui,
    options: &[(&str, C, bool)],
    left: impl FnOnce(&mut Ui) -> Option<C>,
) -> Option<C> {
    ui.add_space(theme::HALF);
    ui.horizontal(|ui| {
        let mut chosen = left(ui);
        at_right(ui, |ui| {
            for (text, choice, is_main) in options {
                let button = match is_main {
                    true => main_button(text),
                    false => egui::Button::new(*text),
                };
                if ui.add(button.min_size(vec2(72.0, theme::ROW))).clicked() {
                    chosen = Some(*choice);
                }
            }
        });
        chosen
    })
    .inner
}
