//! Rows of settings and parameters, and the folders that hold them.

use eframe::egui::{self, Ui};

use crate::{
    app::{
        command::{Command, Commands, Edit, Parameter},
        fields::{Outcome, Row, row_ui},
        session::Session,
        state::State,
        theme,
    },
    params::Value,
    preset::settings::Setting,
};

/// A folder of the inspector; `open` at the start.
pub fn folder(ui: &mut Ui, title: &str, open: bool, contents: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(theme::heading(title)).default_open(open).show_unindented(ui, |ui| {
        ui.add_space(2.0);
        contents(ui);
        ui.add_space(theme::GAP);
    });
}

/// A folder of settings, by their paths.
pub fn settings_folder(ui: &mut Ui, state: &State, commands: &Commands, (title, open): (&str, bool), paths: &[&str]) {
    folder(ui, title, open, |ui| paths.iter().for_each(|path| setting_ui(ui, state, commands, path)));
}

/// The row of a setting; nothing if it does not apply to the preset.
pub fn setting_ui(ui: &mut Ui, state: &State, commands: &Commands, path: &str) {
    let Some(setting) = Setting::find(path) else { return };
    let preset = state.session.preset();
    let Some(value) = setting.get(preset) else { return };
    let row = Row::of_setting(setting, preset);
    if let Some(value) = send(commands, &row, &value, row_ui(ui, &row, &value)) {
        commands.edit(Edit::Setting(setting, value));
    }
}

/// The row of a parameter of an enabled effect, with the value at the time shown.
pub fn parameter_ui(ui: &mut Ui, session: &Session, commands: &Commands, (effect, field): Parameter, words: &[u32]) {
    let row = Row::of_field(effect, field, words).keyed(session.keying(effect, field));
    let value = field.value(words);
    if let Some(value) = send(commands, &row, &value, row_ui(ui, &row, &value)) {
        commands.edit(Edit::Parameter((effect, field), value));
    }
}

/// Sends what came of a row, besides its new value, which it returns.
fn send(commands: &Commands, row: &Row, value: &Value, outcome: Outcome) -> Option<Value> {
    if outcome.is_hovered {
        commands.send(Command::HoverRow { path: row.path.clone(), value: row.written(value) });
    }
    if let Some(command) = outcome.command {
        commands.send(Command::Row(command));
    }
    outcome.value
}
