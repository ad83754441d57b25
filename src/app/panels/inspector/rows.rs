//! Rows of settings and parameters, and the folders that hold them.

use eframe::egui::{self, Ui};

use crate::{
    app::{
        command::Commands,
        fields::{Row, row_ui},
        state::State,
        theme,
    },
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
    row_ui(ui, commands, &Row::of_setting(setting, preset), &value);
}
