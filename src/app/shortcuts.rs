//! Keys: one table for the keyboard, the menus and the cheat sheet.

use eframe::egui::{self, Event, Key, KeyboardShortcut, Modifiers, RichText, Ui};

use super::{App, Level, dialogs::Dialog, orbit, theme};
use crate::{effects::Effect, math::hash_unit, params::ValueType, preset_file};

/// What a key or a menu can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Open,
    Save,
    SaveAs,
    Export,
    CopyPreset,
    PastePreset,
    Quit,
    Undo,
    Redo,
    Randomize,
    PreviousPreset,
    NextPreset,
    Frame,
    Front,
    Side,
    Top,
    Orthographic,
    Play,
    StepBack,
    StepForward,
    Rewind,
    RemoveKey,
    Verify,
    Extremes,
    Overlays,
    Compare,
    FlipAb,
    Sweep,
    Panels,
    Timeline,
    Log,
    CheatSheet,
}

const COMMAND: Modifiers = Modifiers::COMMAND;
const COMMAND_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

const fn plain(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}

const fn shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

const fn command(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(COMMAND, key)
}

/// Every action with its words and its keys. Those with Shift stand before those without, so that they are tried first.
const TABLE: &[(Action, &str, &[KeyboardShortcut])] = &[
    (Action::Redo, "Redo", &[KeyboardShortcut::new(COMMAND_SHIFT, Key::Z), command(Key::Y)]),
    (Action::Undo, "Undo", &[command(Key::Z)]),
    (Action::SaveAs, "Save as…", &[KeyboardShortcut::new(COMMAND_SHIFT, Key::S)]),
    (Action::Save, "Save", &[command(Key::S)]),
    (Action::Open, "Open…", &[command(Key::O)]),
    (Action::Export, "Export PNG…", &[plain(Key::F12), command(Key::E)]),
    (Action::CopyPreset, "Copy look", &[]),
    (Action::PastePreset, "Paste look", &[]),
    (Action::Quit, "Quit", &[command(Key::Q)]),
    (Action::PreviousPreset, "Previous preset", &[plain(Key::OpenBracket)]),
    (Action::NextPreset, "Next preset", &[plain(Key::CloseBracket)]),
    (Action::Randomize, "Randomize effects", &[plain(Key::R)]),
    (Action::Frame, "Frame the scene", &[plain(Key::Home)]),
    (Action::Front, "Front view", &[plain(Key::Num1)]),
    (Action::Side, "Side view", &[plain(Key::Num3)]),
    (Action::Top, "Top view", &[plain(Key::Num7)]),
    (Action::Orthographic, "Orthographic or perspective", &[plain(Key::Num5)]),
    (Action::Play, "Play or pause", &[plain(Key::Space)]),
    (Action::StepBack, "Step back 1/30 s", &[plain(Key::Comma)]),
    (Action::StepForward, "Step forward 1/30 s", &[plain(Key::Period)]),
    (Action::Rewind, "Back to the start", &[plain(Key::Num0)]),
    (Action::RemoveKey, "Remove the selected key", &[plain(Key::Delete), plain(Key::Backspace)]),
    (Action::Verify, "Verify against the oracle", &[plain(Key::V)]),
    (Action::Extremes, "Run the extremes…", &[]),
    (Action::Overlays, "Hide or show overlays", &[plain(Key::O)]),
    (Action::Compare, "Compare: wipe, side by side, difference", &[shift(Key::Backslash), plain(Key::Pipe)]),
    (Action::FlipAb, "Flip between the reference and this preset", &[plain(Key::Backslash)]),
    (Action::Sweep, "Hide or show the trade of speed for accuracy", &[plain(Key::M)]),
    (Action::Panels, "Hide or show panels", &[plain(Key::F11)]),
    (Action::Timeline, "Hide or show the timeline", &[plain(Key::T)]),
    (Action::Log, "Hide or show the log", &[plain(Key::L)]),
    (Action::CheatSheet, "Cheat sheet", &[plain(Key::F1), plain(Key::Questionmark)]),
];

/// What a hand on the picture does, for the cheat sheet.
const POINTER: &[(&str, &str)] = &[
    ("Orbit", "left drag"),
    ("Pan", "middle drag, Shift + left drag"),
    ("Zoom", "wheel, pinch"),
    ("Look around and fly", "right drag, with W A S D Q E"),
    ("Frame the scene", "double click"),
    ("Draw particles along", "Ctrl + left drag, where they have an attraction"),
    ("Turn the light", "drag the ball in the corner"),
    ("Reset a value", "double click its label"),
    ("Animate a value", "click the diamond beside it, at two times"),
    ("Scrub", "drag on the timeline's ruler"),
    ("Move a key", "drag its mark, with Shift off the grid"),
    ("Fine slider", "Shift + drag"),
    ("Copy or paste a value", "Ctrl+C, Ctrl+V over its row"),
    ("Copy or paste the preset", "Ctrl+C, Ctrl+V elsewhere"),
];

impl Action {
    fn entry(self) -> &'static (Self, &'static str, &'static [KeyboardShortcut]) {
        TABLE.iter().find(|(action, ..)| *action == self).expect("every action is in the table")
    }

    pub fn about(self) -> &'static str {
        self.entry().1
    }

    /// Its first key, as people write it.
    pub fn keys_text(self) -> String {
        match self {
            Self::CopyPreset => "Ctrl+C".into(),
            Self::PastePreset => "Ctrl+V".into(),
            _ => self.entry().2.first().map_or_else(String::new, written),
        }
    }
}

fn written(shortcut: &KeyboardShortcut) -> String {
    let Modifiers { shift, command, .. } = shortcut.modifiers;
    let command_name = if cfg!(target_os = "macos") { "Cmd+" } else { "Ctrl+" };
    format!("{}{}{}", if command { command_name } else { "" }, if shift { "Shift+" } else { "" }, shortcut.logical_key.symbol_or_name())
}

impl App {
    /// Carries out what the keyboard asks for. Value keys yield to whatever is being typed into or has the focus.
    pub(super) fn take_keys(&mut self, ctx: &egui::Context) {
        if self.dialog.is_some() {
            return;
        }
        let typing = ctx.text_edit_focused();
        let focused = ctx.egui_wants_keyboard_input();
        let flying = ctx.input(|i| i.pointer.secondary_down());
        for (action, _, keys) in TABLE {
            let allowed = |k: &&KeyboardShortcut| if k.modifiers.command { !typing } else { !focused && !flying };
            let hit = keys.iter().filter(allowed).any(|key| ctx.input_mut(|i| i.consume_shortcut(key)));
            if hit {
                self.perform(ctx, *action);
            }
        }
        if !typing {
            self.take_clipboard(ctx);
        }
    }

    fn take_clipboard(&mut self, ctx: &egui::Context) {
        let events = ctx.input(|i| i.events.clone());
        for event in events {
            match event {
                Event::Copy => match self.hovered_row.clone() {
                    Some((_, value)) => self.answer(ctx, super::Ask::Copy(value)),
                    None => self.perform(ctx, Action::CopyPreset),
                },
                Event::Paste(text) => self.paste(&text),
                _ => {}
            }
        }
    }

    pub(super) fn perform(&mut self, ctx: &egui::Context, action: Action) {
        if !matches!(action, Action::Undo | Action::Redo) {
            self.history.close();
        }
        match action {
            Action::Open => self.dialog = Some(Dialog::open(self.options.presets_dir.as_deref())),
            Action::Save => self.save(),
            Action::SaveAs => self.ask_save_as(),
            Action::Export => self.ask_export(),
            Action::CopyPreset => {
                ctx.copy_text(preset_file::to_line(&self.preset_file));
                self.tell(Level::Info, "Copied the preset as one line of text");
            }
            Action::PastePreset => ctx.send_viewport_cmd(egui::ViewportCommand::RequestPaste),
            Action::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Action::Undo => {
                self.observe(false);
                let moment = self.history.undo();
                self.restore(moment, "undo");
            }
            Action::Redo => {
                self.observe(false);
                let moment = self.history.redo();
                self.restore(moment, "redo");
            }
            Action::Randomize => self.randomize(),
            Action::PreviousPreset => self.neighbour_preset(-1),
            Action::NextPreset => self.neighbour_preset(1),
            Action::Frame => self.frame_scene(),
            Action::Front => self.move_camera(|c| orbit::look_along(c, orbit::FRONT)),
            Action::Side => self.move_camera(|c| orbit::look_along(c, orbit::SIDE)),
            Action::Top => self.move_camera(|c| orbit::look_along(c, orbit::TOP)),
            Action::Orthographic => self.move_camera(orbit::toggle_orthographic),
            Action::Play => self.play_or_pause(),
            Action::StepBack => self.step_time(-1.0),
            Action::StepForward => self.step_time(1.0),
            Action::Rewind => self.rewind(),
            Action::RemoveKey => self.remove_selected_key(),
            Action::Verify => self.verify(),
            Action::Extremes => self.extremes.toggle(),
            Action::Overlays => self.overlays.toggle(),
            Action::Compare => self.compare.cycle(),
            Action::FlipAb => self.compare.flip(),
            Action::Panels => {
                let shown = self.panels.left || self.panels.right || self.panels.timeline;
                (self.panels.left, self.panels.right, self.panels.timeline) = (!shown, !shown, !shown);
            }
            Action::Timeline => self.panels.timeline = !self.panels.timeline,
            Action::Sweep => self.panels.sweep = !self.panels.sweep,
            Action::Log => self.panels.log = !self.panels.log,
            Action::CheatSheet => self.panels.cheat_sheet = !self.panels.cheat_sheet,
        }
    }

    /// Draws every parameter of the enabled effects from its soft range.
    fn randomize(&mut self) {
        if self.preset_file.preset.stack.0.is_empty() {
            return self.tell(Level::Info, "No effect is enabled, so there is nothing to randomize");
        }
        self.seed = self.seed.wrapping_add(1);
        let seed = self.seed;
        for enabled in &mut self.preset_file.preset.stack.0 {
            randomize_words(enabled.effect, &mut enabled.words, seed);
        }
        self.tell(Level::Info, format!("Randomized with seed {seed}"));
    }

    pub(super) fn cheat_sheet_ui(&mut self, ctx: &egui::Context) {
        let mut open = self.panels.cheat_sheet;
        let area = ctx.content_rect();
        egui::Window::new("Cheat sheet")
            .open(&mut open)
            .collapsible(false)
            .resizable(false)
            .default_width(420.0)
            .pivot(egui::Align2::CENTER_CENTER)
            .default_pos(area.center())
            .show(ctx, |ui| {
                let search =
                    egui::TextEdit::singleline(&mut self.panels.search).hint_text("Search actions and keys").desired_width(f32::INFINITY);
                ui.add(search);
                ui.add_space(theme::HALF);
                egui::ScrollArea::vertical().max_height((area.height() - 220.0).max(160.0)).show(ui, |ui| self.cheat_rows_ui(ui));
            });
        self.panels.cheat_sheet = open;
        if open && ctx.input(|i| i.key_pressed(Key::Escape)) {
            self.panels.cheat_sheet = false;
        }
    }

    fn cheat_rows_ui(&self, ui: &mut Ui) {
        let wanted = self.panels.search.to_lowercase();
        let keys = TABLE.iter().map(|(action, about, keys)| {
            let keys = keys.iter().map(written).collect::<Vec<_>>().join("  ");
            (*about, if keys.is_empty() { action.keys_text() } else { keys }, self.current_value(*action))
        });
        let pointer = POINTER.iter().map(|(about, how)| (*about, (*how).to_owned(), None));
        let rows: Vec<_> =
            keys.chain(pointer).filter(|(about, how, _)| format!("{about} {how}").to_lowercase().contains(&wanted)).collect();
        if rows.is_empty() {
            ui.label(theme::weak("No action has these words."));
        }
        egui::Grid::new("cheat sheet").num_columns(3).spacing([24.0, 6.0]).show(ui, |ui| {
            for (about, how, value) in rows {
                ui.label(about);
                ui.label(RichText::new(how).monospace().color(theme::TEXT_STRONG));
                ui.label(theme::weak(value.unwrap_or_default()));
                ui.end_row();
            }
        });
    }

    /// What an action would change, as it stands.
    fn current_value(&self, action: Action) -> Option<String> {
        match action {
            Action::Undo => Some(format!("{} steps", self.history.steps())),
            Action::Save => Some(if self.is_modified() { "unsaved".into() } else { "saved".into() }),
            Action::Play => Some(if self.playback.playing { "playing".into() } else { "paused".into() }),
            Action::Randomize => Some(format!("seed {}", self.seed)),
            Action::Timeline => Some(if self.panels.timeline { "shown".into() } else { "hidden".into() }),
            Action::Overlays => Some(if self.overlays.is_any() { "shown".into() } else { "hidden".into() }),
            Action::Sweep => Some(if self.panels.sweep { "shown".into() } else { "hidden".into() }),
            Action::Log => Some(if self.panels.log { "shown".into() } else { "hidden".into() }),
            _ => None,
        }
    }
}

/// One draw per lane, from the seed and the parameter's own name, so that another order gives the same values.
fn randomize_words(effect: &Effect, words: &mut [u32], seed: u32) {
    for field in effect.fields {
        let salt =
            effect.name.bytes().chain(field.name.bytes()).fold(seed.wrapping_mul(0x9e37_79b9), |h, b| h.rotate_left(5) ^ u32::from(b));
        let [from, to] = field.soft;
        let values: Vec<f64> = (0..field.value_type.components() as u32)
            .map(|lane| {
                let share = hash_unit(salt.wrapping_add(lane.wrapping_mul(0x85eb_ca6b)));
                match field.value_type {
                    ValueType::Color if lane == 3 => 1.0,
                    ValueType::U32 | ValueType::I32 | ValueType::Bool | ValueType::Choice(_) => {
                        (from + share * (to - from + 1.0)).floor().min(to)
                    }
                    ValueType::F32 if field.log && from > 0.0 => from * (to / from).powf(share),
                    _ => from + share * (to - from),
                }
            })
            .collect();
        // The soft range lies within the hard one, so this is never refused.
        let _ = field.set(words, &values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    #[test]
    fn no_two_actions_share_a_key() {
        let keys: Vec<_> = TABLE.iter().flat_map(|(_, _, keys)| *keys).collect();
        for (i, key) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(key), "{key:?}");
        }
    }

    #[test]
    fn randomized_values_stay_in_their_soft_range_and_depend_on_the_seed() {
        for effect in EFFECTS {
            let draw = |seed| {
                let mut words = (effect.defaults)();
                randomize_words(effect, &mut words, seed);
                words
            };
            assert_eq!(draw(7), draw(7));
            assert_ne!(draw(7), draw(8), "{}", effect.name);
            for field in effect.fields {
                let [from, to] = field.soft;
                assert!(field.get(&draw(7)).iter().all(|v| (from..=to).contains(v)), "{}.{}", effect.name, field.name);
            }
        }
    }
}
