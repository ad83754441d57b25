//! The cheat sheet: every action with its shortcut and its present value, to be searched.

use eframe::egui::{self, Key, RichText, Ui};

use crate::app::{
    shell::{
        action::{Action, POINTER, actions, shortcut_text},
        command::Commands,
        state::State,
    },
    widgets::{panel::Panel, theme},
};

/// Every action with its shortcut and its present value, to be searched.
#[derive(Default)]
pub struct CheatSheet {
    search: String,
}

impl Panel for CheatSheet {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let ctx = ui.ctx().clone();
        let mut is_open = state.open.cheat_sheet;
        if !is_open {
            self.search.clear();
            return;
        }
        let area = ctx.content_rect();
        egui::Window::new("Cheat sheet")
            .open(&mut is_open)
            .collapsible(false)
            .resizable(false)
            .default_width(420.0)
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(area.center())
            .show(&ctx, |ui| {
                let search = egui::TextEdit::singleline(&mut self.search)
                    .hint_text("Search actions and keys")
                    .desired_width(f32::INFINITY);
                let search = ui.add(search).accessible_name("Search actions and keys");
                // Keys that are typed while the sheet is open go into the search.
                if ui.memory(|memory| memory.focused().is_none()) {
                    search.request_focus();
                }
                ui.add_space(theme::HALF);
                let height = (area.height() - 220.0).max(160.0);
                egui::ScrollArea::vertical()
                    .max_height(height)
                    .show(ui, |ui| rows_ui(ui, &self.search, state));
            });
        // The key that opens it closes it, too; the search would keep it.
        is_open &= !ctx.input(|i| i.key_pressed(Key::F1));
        if state.open.cheat_sheet && !is_open {
            commands.perform(Action::CheatSheet);
        }
    }
}

/// Actions and pointer gestures that contain `search`.
fn rows_ui(ui: &mut Ui, search: &str, state: &State) {
    let search = search.to_lowercase();
    let actions = actions().map(|(action, label, _)| {
        let shortcuts = state
            .settings
            .keys
            .of(*action)
            .iter()
            .map(shortcut_text)
            .collect::<Vec<_>>()
            .join("  ");
        (
            *label,
            if shortcuts.is_empty() {
                action.shortcut_text()
            } else {
                shortcuts
            },
            value_text(*action, state),
        )
    });
    let pointer = POINTER
        .iter()
        .map(|(label, gesture)| (*label, (*gesture).to_owned(), None));
    let rows: Vec<_> = actions
        .chain(pointer)
        .filter(|(label, how, _)| format!("{label} {how}").to_lowercase().contains(&search))
        .collect();
    if rows.is_empty() {
        ui.label(theme::weak("No action matches."));
    }
    egui::Grid::new("cheat sheet")
        .num_columns(3)
        .spacing([24.0, 6.0])
        .show(ui, |ui| {
            for (label, how, value) in rows {
                ui.label(label);
                ui.label(RichText::new(how).monospace().color(theme::text_strong()));
                ui.label(theme::weak(value.unwrap_or_default()));
                ui.end_row();
            }
        });
}

/// The present value of what an action changes.
fn value_text(action: Action, state: &State) -> Option<String> {
    let shown = |is_shown: bool| if is_shown { "shown" } else { "hidden" }.to_owned();
    match action {
        Action::Undo => Some(format!("{} steps", state.history.steps())),
        Action::Save => Some(if state.session.is_modified() {
            "unsaved".into()
        } else {
            "saved".into()
        }),
        Action::Play => Some(if state.session.playback.playing {
            "playing".into()
        } else {
            "paused".into()
        }),
        Action::Randomize => Some(format!("seed {}", state.session.randomizer.seed())),
        Action::Timeline => Some(shown(state.open.timeline)),
        Action::Overlays => Some(shown(state.picture.overlays.is_any())),
        Action::Handles => Some(shown(state.open.handles)),
        Action::Trade => Some(shown(state.open.trade)),
        Action::Log => Some(shown(state.open.log)),
        _ => None,
    }
}
