//! The settings window: theme, size of texts and controls, and the cheat sheet: every action with
//! its keys, which can be changed, and its present value.

use egui::{self, Button, Event, Key, Label, RichText, Ui, vec2};

use crate::app::panels::panel::{Panel, performs};
use crate::app::{
    settings::{
        SCALES,
        keymap::{self, Keymap},
    },
    shell::{
        action::{Action, POINTER, actions, shortcut_text},
        command::Commands,
        log::Level,
        state::State,
    },
    widgets::{
        form::{field_ui, form_ui, is_entered, search_ui, words_ui},
        icons::{Icon, icon_button},
        panel::{at_right, centered_window},
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

    /// The cheat sheet: actions and gestures of the pointer that contain what is searched.
    fn keys_ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands, height: f32) {
        ui.horizontal(|ui| {
            ui.label(theme::heading("Keys"));
            at_right(ui, |ui| {
                let reset = ui.button("Reset all");
                let hint = "Give every action its own keys again";
                if reset.on_hover_text(hint).clicked() {
                    commands.run(|app| app.state.settings.keys.reset_all());
                }
            });
        });
        let field = search_ui(ui, &mut self.search, "Search actions and keys");
        if self.binding.is_none() {
            // Keys that are typed while the window is open go into the search.
            is_entered(ui, &field);
        }
        ui.add_space(theme::HALF);
        let search = self.search.to_lowercase();
        let is_found =
            |label: &str, how: &str| format!("{label} {how}").to_lowercase().contains(&search);
        let rows = egui::ScrollArea::vertical()
            .max_height(height)
            .min_scrolled_height(height);
        rows.auto_shrink([false, false]).show(ui, |ui| {
            let mut count = 0;
            for (action, label, _) in actions() {
                let keys = state.settings.keys.of(*action).iter().map(shortcut_text);
                let keys = match keys.collect::<Vec<_>>().join("  ") {
                    none if none.is_empty() => action.shortcut_text(),
                    keys => keys,
                };
                if is_found(label, &keys) {
                    count += 1;
                    ui.horizontal(|ui| self.key_ui(ui, state, commands, (*action, label, &keys)));
                }
            }
            for (label, gesture) in POINTER.iter().filter(|(label, how)| is_found(label, how)) {
                count += 1;
                ui.horizontal(|ui| {
                    label_ui(ui, 190.0, label);
                    ui.add(Label::new(RichText::new(*gesture).monospace()).truncate());
                });
            }
            if count == 0 {
                ui.label(theme::weak("No action matches."));
            }
        });
    }

    /// An action with its keys, the button that changes them, and its present value.
    fn key_ui(
        &mut self,
        ui: &mut Ui,
        state: &State,
        commands: &Commands,
        (action, label, keys): (Action, &str, &str),
    ) {
        label_ui(ui, 190.0, label);
        if matches!(action, Action::CopyPreset | Action::PastePreset) {
            // The system sends these as events of the clipboard, whatever their keys are.
            ui.label(theme::weak(keys).monospace());
            return;
        }
        let is_waiting = self.binding == Some(action);
        let (text, color) = match (is_waiting, keys) {
            (true, _) => ("Press a key", theme::accent()),
            (false, "") => ("none", theme::text_weak()),
            (false, keys) => (keys, theme::text_strong()),
        };
        let button = Button::new(RichText::new(text).monospace().color(color))
            .min_size(vec2(170.0, theme::ROW - 2.0))
            .selected(is_waiting);
        let button = ui
            .add(button)
            .on_hover_text("Press another key for this")
            .accessible_name(format!("Keys of {label}"));
        if button.clicked() {
            self.binding = (!is_waiting).then_some(action);
        }
        let clear = ui.add_enabled_ui(!keys.is_empty(), |ui| {
            icon_button(ui, Icon::Cross, &format!("No key for {label}"))
        });
        if clear.inner.clicked() {
            commands.run(move |app| app.state.settings.keys.clear(action));
        }
        if state.settings.keys.is_bound(action)
            && icon_button(ui, Icon::Reset, &format!("Reset keys of {label}")).clicked()
        {
            Self::change(commands, move |keys| keys.reset(action));
        }
        if let Some(value) = value_text(action, state) {
            at_right(ui, |ui| ui.label(theme::weak(value)));
        }
    }
}

impl Panel for SettingsWindow {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        if !state.open.settings {
            *self = Self::default();
            return;
        }
        self.take_key(ui, commands);
        let area = ui.ctx().content_rect();
        let mut is_open = true;
        centered_window(ui.ctx(), "Settings", &mut is_open).show(ui.ctx(), |ui| {
            ui.set_width(560.0f32.min(area.width() - 48.0));
            form_ui(ui, "settings", |ui| {
                field_ui(ui, "Theme", "", |ui| {
                    let mut theme = state.settings.theme;
                    let themes = ThemeChoice::ALL.map(|choice| (choice, choice.label(), ""));
                    if words_ui(ui, "", &mut theme, themes) {
                        commands
                            .run(move |app| app.change_settings(|settings| settings.theme = theme));
                    }
                });
                field_ui(ui, "Texts and controls", "", |ui| {
                    scale_ui(ui, state.settings.scale, commands);
                });
            });
            ui.separator();
            let height = (area.height() - 260.0).clamp(120.0, 480.0);
            self.keys_ui(ui, state, commands, height);
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
        ui.add(Label::new(text).truncate());
    });
}

/// Size of texts and controls.
fn scale_ui(ui: &mut Ui, scale: f32, commands: &Commands) {
    for (text, action, is_enabled) in [
        ("\u{2212}", Action::ScaleDown, scale > SCALES[0]),
        ("+", Action::ScaleUp, scale < SCALES[1]),
        ("Reset", Action::ScaleReset, scale != 1.0),
    ] {
        if action == Action::ScaleUp {
            let percent = Label::new(format!("{:.0} %", scale * 100.0));
            ui.add_sized([52.0, theme::ROW], percent);
        }
        let button = Button::new(text).min_size(vec2(28.0, theme::ROW - 2.0));
        let button = ui.add_enabled(is_enabled, button);
        performs(button.accessible_name(action.label()), commands, action);
    }
}

/// The present value of what an action changes.
fn value_text(action: Action, state: &State) -> Option<String> {
    let open = &state.open;
    let seed = state.session.randomizer.seed();
    let (is_so, yes, no) = match action {
        Action::Undo => return Some(format!("{} steps", state.history.steps())),
        Action::Randomize => return Some(format!("seed {seed}")),
        Action::Save => (state.session.is_modified(), "unsaved", "saved"),
        Action::Play => (state.session.playback.playing, "playing", "paused"),
        Action::Timeline => (open.timeline, "shown", "hidden"),
        Action::Overlays => (state.picture.overlays.is_any(), "shown", "hidden"),
        Action::Handles => (open.handles, "shown", "hidden"),
        Action::Trade => (open.trade, "shown", "hidden"),
        Action::Log => (open.log, "shown", "hidden"),
        _ => return None,
    };
    Some(if is_so { yes } else { no }.into())
}
