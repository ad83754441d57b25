//! Changing settings from the window.

use eframe::egui;

use super::Settings;
use crate::app::shell::command::SettingsCommand;

impl Settings {
    /// Carries out `command`, and shows what it changes at once.
    ///
    /// # Errors
    /// In words, if a key belongs to another action.
    pub fn change(&mut self, ctx: &egui::Context, command: SettingsCommand) -> Result<(), String> {
        match command {
            SettingsCommand::Theme(theme) => {
                self.theme = theme;
                theme.choose(ctx);
            }
            SettingsCommand::Scale(steps) => self.change_scale(steps),
            SettingsCommand::ResetScale => self.scale = 1.0,
            SettingsCommand::Bind(action, Some(shortcut)) => self.keys.bind(action, shortcut)?,
            SettingsCommand::Bind(action, None) => self.keys.clear(action),
            SettingsCommand::ResetKeys(action) => self.keys.reset(action)?,
            SettingsCommand::ResetAllKeys => self.keys.reset_all(),
        }
        ctx.set_zoom_factor(self.scale);
        Ok(())
    }
}
