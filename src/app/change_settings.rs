//! Changes settings as the panel Settings asks.

use eframe::egui;

use super::{command::SettingsCommand, log::Level, state::State};

/// Carries out `command` and shows the changed settings at once.
pub fn change_settings(ctx: &egui::Context, state: &mut State, command: SettingsCommand) {
    let settings = &mut state.settings;
    let outcome = match command {
        SettingsCommand::Theme(theme) => {
            settings.theme = theme;
            theme.choose(ctx);
            Ok(())
        }
        SettingsCommand::Scale(steps) => {
            settings.change_scale(steps);
            Ok(())
        }
        SettingsCommand::ResetScale => {
            settings.scale = 1.0;
            Ok(())
        }
        SettingsCommand::Bind(action, Some(shortcut)) => settings.keys.bind(action, shortcut),
        SettingsCommand::Bind(action, None) => {
            settings.keys.clear(action);
            Ok(())
        }
        SettingsCommand::ResetKeys(action) => settings.keys.reset(action),
        SettingsCommand::ResetAllKeys => {
            settings.keys.reset_all();
            Ok(())
        }
    };
    ctx.set_zoom_factor(settings.scale);
    if let Err(refused) = outcome {
        state.notify(Level::Warning, refused);
    }
}
