//! The settings window: theme, size of texts and controls, and the keys of every action.

use eframe::egui::{self, Event, Key, RichText, Ui, vec2};

use crate::app::{
    settings::{
        SCALES,
        keymap::{self, Keymap},
    },
    shell::{
        action::{Action, actions, shortcut_text},
        command::Commands,
        log::Level,
        state::State,
    },
    widgets::{
        icons::{Icon, icon_button},
        panel::Panel,
        theme::{self, ThemeChoice},
    },
};

/// The settings window.
#[derive(Default)]
pub struct SettingsWindow {
    search: String,
    /// The action whose next key is awaited.
    binding: Option<Action>,
}

impl SettingsWindow {
    /// True while the next key is to be bound, and does nothing else.
    pub fn takes_key(&self) -> bool {
        self.binding.is_some()
    }

    /// Changes the keys; a key that belongs to another action is refused.
    fn change(
        commands: &Commands,
        change: impl FnOnce(&mut Keymap) -> Result<(), String> + 'static,
    ) {
        commands.run(|app| {
            if let Err(refused) = change(&mut app.state.settings.keys) {
                app.notify(Level::Warning, refused);
            }
        });
    }

    /// Takes the key that is pressed for the action that waits for one. Escape ends the waiting.
    fn take_key(&mut self, ui: &Ui, commands: &Commands) {
        let Some(action) = self.binding else { return };
        let pressed = ui.input_mut(|i| {
            let pressed = i.events.iter().find_map(|event| match event {
                Event::Key {
                    key,
                    modifiers,
                    pressed: true,
                    ..
                } => Some((*key, *modifiers)),
                _ => None,
            });
            i.events
                .retain(|event| !matches!(event, Event::Key { .. } | Event::Text(_)));
            pressed
        });
        let Some((key, modifiers)) = pressed else {
            return;
        };
        self.binding = None;
        if key != Key::Escape {
            let shortcut = keymap::pressed(key, modifiers);
            Self::change(commands, move |keys| keys.bind(action, shortcut));
        }
    }

    fn keys_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands, height: f32) {
        ui.horizontal(|ui| {
            ui.label(theme::heading("Keys"));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui
                    .button("Reset all")
                    .on_hover_text("Give every action its own keys again")
                    .clicked()
                {
                    commands.run(|app| app.state.settings.keys.reset_all());
                }
                let search = egui::TextEdit::singleline(&mut self.search)
                    .hint_text("Search")
                    .desired_width(160.0);
                ui.add(search).accessible_name("Search keys");
            });
        });
        let search = self.search.to_lowercase();
        let keys = &state.settings.keys;
        egui::ScrollArea::vertical()
            .max_height(height)
            .auto_shrink([false, false])
            .show(ui, |ui| {
                for (action, label, _) in actions() {
                    let shortcuts = keys
                        .of(*action)
                        .iter()
                        .map(shortcut_text)
                        .collect::<Vec<_>>()
                        .join("  ");
                    if !format!("{label} {shortcuts}")
                        .to_lowercase()
                        .contains(&search)
                    {
                        continue;
                    }
                    ui.horizontal(|ui| {
                        ui.set_min_height(theme::ROW);
                        label_ui(ui, 230.0, label);
                        if matches!(action, Action::CopyPreset | Action::PastePreset) {
                            // The system sends these as events of the clipboard, whatever their
                            // keys are.
                            ui.label(
                                RichText::new(action.shortcut_text())
                                    .monospace()
                                    .color(theme::text_weak()),
                            );
                            return;
                        }
                        let is_waiting = self.binding == Some(*action);
                        let text = if is_waiting {
                            "Press a key"
                        } else if shortcuts.is_empty() {
                            "none"
                        } else {
                            &shortcuts
                        };
                        let color = if is_waiting {
                            theme::accent()
                        } else if shortcuts.is_empty() {
                            theme::text_weak()
                        } else {
                            theme::text_strong()
                        };
                        let button =
                            egui::Button::new(RichText::new(text).monospace().color(color))
                                .min_size(vec2(150.0, theme::ROW - 2.0));
                        let button = ui
                            .add(button.selected(is_waiting))
                            .on_hover_text("Press another key for this");
                        if button.accessible_name(format!("Keys of {label}")).clicked() {
                            self.binding = if is_waiting { None } else { Some(*action) };
                        }
                        let can_clear = !shortcuts.is_empty();
                        if ui
                            .add_enabled_ui(can_clear, |ui| {
                                icon_button(ui, Icon::Cross, &format!("No key for {label}"))
                            })
                            .inner
                            .clicked()
                        {
                            commands.run(|app| app.state.settings.keys.clear(*action));
                        }
                        if keys.is_bound(*action)
                            && icon_button(ui, Icon::Reset, &format!("Reset keys of {label}"))
                                .clicked()
                        {
                            Self::change(commands, |keys| keys.reset(*action));
                        }
                    });
                }
            });
    }
}

impl Panel for SettingsWindow {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        if !state.open.settings {
            self.binding = None;
            return;
        }
        self.take_key(ui, commands);
        let area = ui.ctx().content_rect();
        let mut is_open = true;
        egui::Window::new("Settings")
            .open(&mut is_open)
            .collapsible(false)
            .resizable(false)
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(area.center())
            .show(ui.ctx(), |ui| {
                ui.set_width(500.0f32.min(area.width() - 48.0));
                ui.horizontal(|ui| {
                    label_ui(ui, 150.0, "Theme");
                    for choice in ThemeChoice::ALL {
                        if ui
                            .selectable_label(state.settings.theme == choice, choice.label())
                            .clicked()
                        {
                            commands.run(move |app| {
                                app.change_settings(|settings| settings.theme = choice)
                            });
                        }
                    }
                });
                scale_ui(ui, state.settings.scale, commands);
                ui.separator();
                self.keys_ui(
                    ui,
                    state,
                    commands,
                    (area.height() - 260.0).clamp(120.0, 420.0),
                );
            });
        if !is_open {
            commands.perform(Action::Settings);
        }
    }
}

/// A label at the left of a column of this width.
fn label_ui(ui: &mut Ui, width: f32, text: &str) {
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    ui.allocate_ui_with_layout(vec2(width, theme::ROW), layout, |ui| {
        ui.set_min_width(width);
        ui.add(egui::Label::new(text).truncate());
    });
}

/// Size of texts and controls.
fn scale_ui(ui: &mut Ui, scale: f32, commands: &Commands) {
    ui.horizontal(|ui| {
        label_ui(ui, 150.0, "Texts and controls");
        for (text, action, is_enabled) in [
            ("\u{2212}", Action::ScaleDown, scale > SCALES[0]),
            ("+", Action::ScaleUp, scale < SCALES[1]),
            ("100 %", Action::ScaleReset, true),
        ] {
            if action == Action::ScaleUp {
                ui.add_sized(
                    [52.0, theme::ROW],
                    egui::Label::new(format!("{:.0} %", scale * 100.0)),
                );
            }
            let button = ui.add_enabled(
                is_enabled,
                egui::Button::new(text).min_size(vec2(28.0, theme::ROW - 2.0)),
            );
            if button
                .on_hover_text(action.hint())
                .accessible_name(action.label())
                .clicked()
            {
                commands.perform(action);
            }
        }
    });
}
