//! Actions: one table for the keyboard, the menus and the cheat sheet.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

/// What a key or a menu entry does.
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
    Timing,
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

/// An action, its label and its shortcuts.
pub type Entry = (Action, &'static str, &'static [KeyboardShortcut]);

/// Every action. A shortcut with Shift comes before the same key without, so that it is matched first.
pub const ACTIONS: &[Entry] = &[
    (Action::Redo, "Redo", &[KeyboardShortcut::new(COMMAND_SHIFT, Key::Z), command(Key::Y)]),
    (Action::Undo, "Undo", &[command(Key::Z)]),
    (Action::SaveAs, "Save as…", &[KeyboardShortcut::new(COMMAND_SHIFT, Key::S)]),
    (Action::Save, "Save", &[command(Key::S)]),
    (Action::Open, "Open…", &[command(Key::O)]),
    (Action::Export, "Export PNG…", &[plain(Key::F12), command(Key::E)]),
    (Action::CopyPreset, "Copy preset", &[]),
    (Action::PastePreset, "Paste preset", &[]),
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
    (Action::Rewind, "Go to the start", &[plain(Key::Num0)]),
    (Action::RemoveKey, "Remove the selected key", &[plain(Key::Delete), plain(Key::Backspace)]),
    (Action::Verify, "Verify against the oracle", &[plain(Key::V)]),
    (Action::Extremes, "Run extreme cases…", &[]),
    (Action::Overlays, "Show or hide overlays", &[plain(Key::O)]),
    (Action::Compare, "Compare: wipe, side by side, difference", &[shift(Key::Backslash), plain(Key::Pipe)]),
    (Action::FlipAb, "Switch between the reference and this preset", &[plain(Key::Backslash)]),
    (Action::Sweep, "Show or hide the accuracy sweep", &[plain(Key::M)]),
    (Action::Timing, "Show or hide timing", &[plain(Key::G)]),
    (Action::Panels, "Show or hide panels", &[plain(Key::F11)]),
    (Action::Timeline, "Show or hide the timeline", &[plain(Key::T)]),
    (Action::Log, "Show or hide the log", &[plain(Key::L)]),
    (Action::CheatSheet, "Cheat sheet", &[plain(Key::F1), plain(Key::Questionmark)]),
];

/// What the pointer does, for the cheat sheet.
pub const POINTER: &[(&str, &str)] = &[
    ("Orbit", "left drag"),
    ("Pan", "middle drag, Shift + left drag"),
    ("Zoom", "wheel, pinch"),
    ("Look around and fly", "right drag, with W A S D Q E"),
    ("Frame the scene", "double click"),
    ("Attract particles", "Ctrl + left drag, if the preset has particles"),
    ("Turn the light", "drag the ball in the corner"),
    ("Reset a value", "double click its label"),
    ("Animate a value", "click the diamond beside it, at two times"),
    ("Scrub", "drag on the timeline's ruler"),
    ("Move a key", "drag its mark; hold Shift to leave the frame grid"),
    ("Fine slider", "Shift + drag"),
    ("Copy or paste a value", "Ctrl+C, Ctrl+V over its row"),
    ("Copy or paste the preset", "Ctrl+C, Ctrl+V elsewhere"),
];

impl Action {
    fn entry(self) -> &'static Entry {
        ACTIONS.iter().find(|(action, ..)| *action == self).expect("every action is in the table")
    }

    /// Label in menus and in the cheat sheet.
    pub fn label(self) -> &'static str {
        self.entry().1
    }

    /// Does it open a field for text?
    pub fn takes_text(self) -> bool {
        matches!(self, Self::Open | Self::Save | Self::SaveAs | Self::Export | Self::CheatSheet)
    }

    /// Its first shortcut as text: `Ctrl+Shift+Z`; empty without one.
    pub fn shortcut_text(self) -> String {
        match self {
            Self::CopyPreset => "Ctrl+C".into(),
            Self::PastePreset => "Ctrl+V".into(),
            _ => self.entry().2.first().map_or_else(String::new, shortcut_text),
        }
    }
}

/// `Ctrl+Shift+Z`.
pub fn shortcut_text(shortcut: &KeyboardShortcut) -> String {
    let Modifiers { shift, command, .. } = shortcut.modifiers;
    let command_name = if cfg!(target_os = "macos") { "Cmd+" } else { "Ctrl+" };
    format!("{}{}{}", if command { command_name } else { "" }, if shift { "Shift+" } else { "" }, shortcut.logical_key.symbol_or_name())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_actions_share_a_key() {
        let keys: Vec<_> = ACTIONS.iter().flat_map(|(_, _, keys)| *keys).collect();
        for (i, key) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(key), "{key:?}");
        }
    }
}
