//! Actions: one table for the keyboard, the menus and the cheat sheet.

use std::cell::RefCell;

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

/// What a key or a menu entry does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Open,
    Save,
    SaveAs,
    Export,
    Film,
    CopyPreset,
    PastePreset,
    CopyLink,
    ExportAll,
    Quit,
    OpenWithScene,
    ForgetRecents,
    Undo,
    Redo,
    AddEffect,
    NewEffect,
    Randomize,
    RandomizeWindow,
    Sweep,
    PreviousPreset,
    NextPreset,
    Frame,
    Front,
    Side,
    Top,
    Orthographic,
    AddBookmark,
    NextBookmark,
    Play,
    StepBack,
    StepForward,
    Rewind,
    RemoveKey,
    Verify,
    Extremes,
    Review,
    AcceptGolden,
    RejectGolden,
    NextGolden,
    Overlays,
    NextPixel,
    PreviousPixel,
    Handles,
    BoundingBox,
    Axes,
    Grid,
    Compare,
    FlipAb,
    Trade,
    Timing,
    Panels,
    Timeline,
    Log,
    Palette,
    CheatSheet,
    Settings,
    ScaleUp,
    ScaleDown,
    ScaleReset,
}

const COMMAND: Modifiers = Modifiers::COMMAND;
const COMMAND_SHIFT: Modifiers = Modifiers {
    shift: true,
    ..Modifiers::COMMAND
};

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

/// Every action with the shortcuts that it has unless the user binds others, see
/// [`Keymap`](crate::app::settings::keymap::Keymap).
pub const ACTIONS: &[Entry] = &[
    (
        Action::Redo,
        "Redo",
        &[
            KeyboardShortcut::new(COMMAND_SHIFT, Key::Z),
            command(Key::Y),
        ],
    ),
    (Action::Undo, "Undo", &[command(Key::Z)]),
    (
        Action::SaveAs,
        "Save as…",
        &[KeyboardShortcut::new(COMMAND_SHIFT, Key::S)],
    ),
    (Action::Save, "Save", &[command(Key::S)]),
    (Action::Open, "Open…", &[command(Key::O)]),
    (
        Action::Film,
        "Export film…",
        &[KeyboardShortcut::new(COMMAND_SHIFT, Key::E)],
    ),
    (
        Action::Export,
        "Export PNG…",
        &[plain(Key::F12), command(Key::E)],
    ),
    (Action::CopyPreset, "Copy preset", &[]),
    (Action::PastePreset, "Paste preset", &[]),
    (Action::CopyLink, "Copy link to a page", &[]),
    (Action::ExportAll, "Export everything", &[]),
    (Action::Quit, "Quit", &[command(Key::Q)]),
    (Action::OpenWithScene, "Open with its scene", &[]),
    (Action::ForgetRecents, "Forget recent files", &[]),
    (
        Action::PreviousPreset,
        "Previous preset",
        &[plain(Key::OpenBracket)],
    ),
    (
        Action::NextPreset,
        "Next preset",
        &[plain(Key::CloseBracket)],
    ),
    (Action::AddEffect, "Add effect…", &[shift(Key::A)]),
    (Action::NewEffect, "New effect of my own…", &[]),
    (
        Action::RandomizeWindow,
        "Randomize: locks and seeds…",
        &[shift(Key::R)],
    ),
    (Action::Randomize, "Randomize effects", &[plain(Key::R)]),
    (Action::Sweep, "Sweep of parameters…", &[shift(Key::S)]),
    (Action::Frame, "Frame the scene", &[plain(Key::Home)]),
    (Action::Front, "Front view", &[plain(Key::Num1)]),
    (Action::Side, "Side view", &[plain(Key::Num3)]),
    (Action::Top, "Top view", &[plain(Key::Num7)]),
    (
        Action::Orthographic,
        "Orthographic or perspective",
        &[plain(Key::Num5)],
    ),
    (Action::AddBookmark, "Bookmark the camera", &[shift(Key::C)]),
    (
        Action::NextBookmark,
        "Next bookmark of the camera",
        &[plain(Key::C)],
    ),
    (Action::Play, "Play or pause", &[plain(Key::Space)]),
    (Action::StepBack, "Step back 1/30 s", &[plain(Key::Comma)]),
    (
        Action::StepForward,
        "Step forward 1/30 s",
        &[plain(Key::Period)],
    ),
    (Action::Rewind, "Go to the start", &[plain(Key::Num0)]),
    (
        Action::RemoveKey,
        "Remove the selected key",
        &[plain(Key::Delete), plain(Key::Backspace)],
    ),
    (
        Action::Verify,
        "Verify against the oracle",
        &[plain(Key::V)],
    ),
    (Action::Extremes, "Run extreme cases…", &[]),
    (Action::Review, "Review of goldens…", &[shift(Key::G)]),
    (
        Action::AcceptGolden,
        "Review: accept the new picture",
        &[plain(Key::Y)],
    ),
    (
        Action::RejectGolden,
        "Review: keep the golden",
        &[plain(Key::X)],
    ),
    (Action::NextGolden, "Review: next preset", &[plain(Key::K)]),
    (Action::Overlays, "Show or hide overlays", &[plain(Key::O)]),
    (
        Action::NextPixel,
        "Next pixel of the overlays",
        &[plain(Key::N)],
    ),
    (
        Action::PreviousPixel,
        "Previous pixel of the overlays",
        &[shift(Key::N)],
    ),
    (
        Action::Handles,
        "Show or hide handles of points and light",
        &[plain(Key::H)],
    ),
    (
        Action::BoundingBox,
        "Show or hide the box of the scene",
        &[plain(Key::B)],
    ),
    (Action::Axes, "Show or hide the axes", &[]),
    (Action::Grid, "Show or hide the grid", &[]),
    (
        Action::Compare,
        "Compare: wipe, side by side, difference",
        &[shift(Key::Backslash), plain(Key::Pipe)],
    ),
    (
        Action::FlipAb,
        "Switch between the reference and this preset",
        &[plain(Key::Backslash)],
    ),
    (
        Action::Trade,
        "Show or hide Trade: time against error",
        &[plain(Key::M)],
    ),
    (Action::Timing, "Show or hide timing", &[plain(Key::G)]),
    (Action::Panels, "Show or hide panels", &[plain(Key::F11)]),
    (
        Action::Timeline,
        "Show or hide the timeline",
        &[plain(Key::T)],
    ),
    (Action::Log, "Show or hide the log", &[plain(Key::L)]),
    (Action::Palette, "Command palette…", &[command(Key::K)]),
    (
        Action::CheatSheet,
        "Cheat sheet",
        &[plain(Key::F1), plain(Key::Questionmark)],
    ),
    (
        Action::Settings,
        "Settings and keys…",
        &[command(Key::Comma)],
    ),
    (
        Action::ScaleUp,
        "Larger texts and controls",
        &[command(Key::Plus), command(Key::Equals)],
    ),
    (
        Action::ScaleDown,
        "Smaller texts and controls",
        &[command(Key::Minus)],
    ),
    (
        Action::ScaleReset,
        "Texts and controls at 100 %",
        &[command(Key::Num0)],
    ),
];

/// What the pointer does, for the cheat sheet.
pub const POINTER: &[(&str, &str)] = &[
    ("Orbit", "left drag"),
    ("Pan", "middle drag, Shift + left drag"),
    ("Zoom", "wheel, pinch"),
    ("Look around and fly", "right drag, with W A S D Q E"),
    ("Frame the scene", "double click"),
    (
        "Attract particles",
        "Ctrl + left drag, if the preset has particles",
    ),
    (
        "Measure a distance",
        "Shift + click on two points of the model",
    ),
    ("Turn the light", "drag the ball in the corner"),
    (
        "Move a point of an effect",
        "drag its ring in the picture; with Shift onto the model",
    ),
    (
        "Open a preset with its scene",
        "Shift + click, where presets land on a model of yours",
    ),
    ("Reset a value", "double click its label"),
    (
        "Animate a value",
        "click the diamond beside it, at two times",
    ),
    ("Scrub", "drag on the timeline's ruler"),
    (
        "Move a key",
        "drag its mark; hold Shift to leave the frame grid",
    ),
    ("Fine slider", "Shift + drag"),
    ("Copy or paste a value", "Ctrl+C, Ctrl+V over its row"),
    ("Copy or paste the preset", "Ctrl+C, Ctrl+V elsewhere"),
];

impl Action {
    /// Does the window have it here? A page has no folders and no thread for all extreme cases; its
    /// tab is closed by the browser. A page alone has files that go with it.
    pub const fn is_here(self) -> bool {
        if matches!(self, Self::ExportAll) {
            return cfg!(target_arch = "wasm32");
        }
        let is_native = matches!(
            self,
            Self::Quit
                | Self::NewEffect
                | Self::Extremes
                | Self::Review
                | Self::AcceptGolden
                | Self::RejectGolden
                | Self::NextGolden
        );
        !is_native || cfg!(not(target_arch = "wasm32"))
    }
}

/// Every action that the window has here.
pub fn actions() -> impl Iterator<Item = &'static Entry> {
    ACTIONS.iter().filter(|(action, ..)| action.is_here())
}

thread_local! {
    /// What the user has bound in the window that this thread shows: actions with their first shortcuts, for the texts that name one.
    static SHOWN: RefCell<Vec<(Action, Option<KeyboardShortcut>)>> = const { RefCell::new(Vec::new()) };
}

/// Makes texts on this thread name these shortcuts for these actions.
pub fn show_shortcuts(bound: Vec<(Action, Option<KeyboardShortcut>)>) {
    SHOWN.set(bound);
}

impl Action {
    fn entry(self) -> &'static Entry {
        ACTIONS
            .iter()
            .find(|(action, ..)| *action == self)
            .expect("every action is in the table")
    }

    /// Label in menus and in the cheat sheet.
    pub fn label(self) -> &'static str {
        self.entry().1
    }

    /// Does it open a field for text?
    pub fn takes_text(self) -> bool {
        matches!(
            self,
            Self::Open
                | Self::Save
                | Self::SaveAs
                | Self::Export
                | Self::Palette
                | Self::AddEffect
                | Self::NewEffect
                | Self::CheatSheet
                | Self::Settings
        )
    }

    /// Its first shortcut as text: `Ctrl+Shift+Z`; empty without one.
    pub fn shortcut_text(self) -> String {
        match self {
            Self::CopyPreset => "Ctrl+C".into(),
            Self::PastePreset => "Ctrl+V".into(),
            _ => SHOWN.with_borrow(|shown| {
                let bound = shown
                    .iter()
                    .find(|(action, _)| *action == self)
                    .map(|(_, shortcut)| *shortcut);
                bound
                    .unwrap_or(self.entry().2.first().copied())
                    .map_or_else(String::new, |shortcut| shortcut_text(&shortcut))
            }),
        }
    }

    /// Its label with its first shortcut: `Undo (Ctrl+Z)`.
    pub fn hint(self) -> String {
        match self.shortcut_text() {
            shortcut if shortcut.is_empty() => self.label().to_owned(),
            shortcut => format!("{} ({shortcut})", self.label()),
        }
    }

    /// The shortcuts that it has unless the user binds others.
    pub fn default_shortcuts(self) -> &'static [KeyboardShortcut] {
        self.entry().2
    }

    /// Its name in the settings file: `previous_preset`.
    pub fn id(self) -> String {
        let mut id = String::new();
        for letter in format!("{self:?}").chars() {
            if letter.is_ascii_uppercase() && !id.is_empty() {
                id.push('_');
            }
            id.push(letter.to_ascii_lowercase());
        }
        id
    }

    /// The action of this name in the settings file.
    pub fn of_id(id: &str) -> Option<Self> {
        ACTIONS
            .iter()
            .map(|(action, ..)| *action)
            .find(|action| action.id() == id)
    }
}

/// `Ctrl+Shift+Z`.
pub fn shortcut_text(shortcut: &KeyboardShortcut) -> String {
    format!(
        "{}{}",
        modifiers_text(shortcut.modifiers),
        shortcut.logical_key.symbol_or_name()
    )
}

/// `Ctrl+Shift+`.
pub fn modifiers_text(modifiers: Modifiers) -> String {
    let command = if cfg!(target_os = "macos") {
        "Cmd+"
    } else {
        "Ctrl+"
    };
    let held = [
        (modifiers.command, command),
        (modifiers.alt, "Alt+"),
        (modifiers.shift, "Shift+"),
    ];
    held.iter()
        .filter(|(is_held, _)| *is_held)
        .map(|(_, name)| *name)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_has_a_name_of_its_own_that_leads_back_to_it() {
        for (action, ..) in ACTIONS {
            assert_eq!(Action::of_id(&action.id()), Some(*action), "{action:?}");
        }
        assert_eq!(Action::PreviousPreset.id(), "previous_preset");
    }

    #[test]
    fn no_two_actions_share_a_key() {
        let keys: Vec<_> = ACTIONS.iter().flat_map(|(_, _, keys)| *keys).collect();
        for (i, key) in keys.iter().enumerate() {
            assert!(!keys[..i].contains(key), "{key:?}");
        }
    }
}
