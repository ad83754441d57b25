//! Actions: one table for the keyboard, the menus and the cheat sheet.

use std::cell::RefCell;

use egui::{Key, KeyboardShortcut, Modifiers, ViewportCommand};

use super::apply::{
    ask_new_effect, copy_link, copy_preset, export_all, toggle_film, toggle_palette, toggle_panels,
    toggle_review,
};
use crate::{
    app::{
        App,
        editing::{apply as editing, preset_edit::Edit},
        files::{apply as files, command::Purpose, open},
        picture::{apply as picture, review::Review},
    },
    scene::camera_moves::{FRONT, SIDE, TOP},
};

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
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const fn command_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(COMMAND_SHIFT, key)
}

/// An action, its label and its shortcuts.
pub type Entry = (Action, &'static str, &'static [KeyboardShortcut]);

/// Declares the actions: the name of each, its label, the shortcuts that it has unless the user binds
/// others (see [`Keymap`](crate::app::settings::keymap::Keymap)), and what it does.
macro_rules! actions {
    ($($action:ident $label:literal [$($keys:expr),*] $run:expr;)*) => {
        /// What a key or a menu entry does.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Action {
            $($action,)*
        }

        /// Every action.
        pub const ACTIONS: &[Entry] = &[$((Action::$action, $label, &[$($keys),*]),)*];

        impl Action {
            fn run(self) -> fn(&mut App) {
                match self {
                    $(Self::$action => $run,)*
                }
            }
        }
    };
}

actions! {
    New "New" [command(Key::N)] open::begin_new;
    Plain "Plain look" [] open::show_plain;
    Open "Open…" [command(Key::O)] |app| files::ask_path(app, Purpose::Open);
    Save "Save" [command(Key::S)] files::save;
    SaveAs "Save as…" [command_shift(Key::S)] |app| files::ask_path(app, Purpose::SaveAs);
    Undo "Undo" [command(Key::Z)] |app| editing::undo(&mut app.state);
    Redo "Redo" [command_shift(Key::Z), command(Key::Y)] |app| editing::redo(&mut app.state);
    Export "Export PNG…" [plain(Key::F12), command(Key::E)] |app| files::ask_path(app, Purpose::Export);
    Film "Export film…" [command_shift(Key::E)] toggle_film;
    CopyPreset "Copy preset" [] copy_preset;
    PastePreset "Paste preset" [] |app| app.ctx.send_viewport_cmd(ViewportCommand::RequestPaste);
    CopyLink "Copy link to a page" [] |app| copy_link(&mut app.state);
    ExportAll "Export everything" [] export_all;
    Quit "Quit" [command(Key::Q)] |app| app.ctx.send_viewport_cmd(ViewportCommand::Close);
    OpenWithScene "Open with its scene" [] files::open_with_scene;
    ForgetRecents "Forget recent files" [] |app| app.state.settings.recents.clear();
    PreviousPreset "Previous preset" [plain(Key::OpenBracket)] |app| files::open_neighbor(app, -1);
    NextPreset "Next preset" [plain(Key::CloseBracket)] |app| files::open_neighbor(app, 1);
    AddEffect "Add effect…" [shift(Key::A)] |app| app.panels.browser.effects.begin_adding(String::new());
    NewEffect "New effect of my own…" [] |app| ask_new_effect(app, None);
    Randomize "Randomize effects" [plain(Key::R)] |app| editing::randomize(&mut app.state);
    RandomizeWindow "Randomize: locks and seeds…" [shift(Key::R)] |app| app.panels.randomize.toggle();
    Sweep "Sweep of parameters…" [shift(Key::S)] |app| app.panels.sweep.toggle();
    Frame "Frame the scene" [plain(Key::Home)] |app| app.edit(Edit::FrameScene);
    Front "Front view, then back" [plain(Key::Num1)] |app| app.edit(Edit::LookAlong(FRONT));
    Side "Side view, then other side" [plain(Key::Num3)] |app| app.edit(Edit::LookAlong(SIDE));
    Top "Top view, then bottom" [plain(Key::Num7)] |app| app.edit(Edit::LookAlong(TOP));
    Orthographic "Orthographic or perspective" [plain(Key::Num5)] |app| app.edit(Edit::ToggleOrthographic);
    AddBookmark "Bookmark the camera" [shift(Key::C)] |app| app.edit(Edit::AddBookmark);
    NextBookmark "Next bookmark of the camera" [plain(Key::C)] |app| app.edit(Edit::NextBookmark);
    Play "Play or pause" [plain(Key::Space)] |app| editing::play_or_pause(&mut app.state);
    StepBack "Step back 1/30 s" [plain(Key::Comma)] |app| app.state.session.step_time(-1.0);
    StepForward "Step forward 1/30 s" [plain(Key::Period)] |app| app.state.session.step_time(1.0);
    Rewind "Go to the start" [plain(Key::Num0)] |app| app.state.session.rewind();
    RemoveKey "Remove the selected key" [plain(Key::Delete), plain(Key::Backspace)] editing::remove_selected_key;
    Verify "Verify against the oracle" [plain(Key::V)] picture::verify;
    Extremes "Run extreme cases…" [] |app| app.panels.extremes.toggle();
    Review "Review of goldens…" [shift(Key::G)] toggle_review;
    AcceptGolden "Review: accept the new picture" [plain(Key::Y)] |app| picture::accept_golden(&mut app.state);
    RejectGolden "Review: keep the golden" [plain(Key::X)] |app| picture::review(&mut app.state, Review::reject);
    NextGolden "Review: next preset" [plain(Key::K)] |app| picture::review(&mut app.state, Review::next);
    Overlays "Show or hide overlays" [plain(Key::O)] |app| app.state.picture.overlays.toggle();
    NextPixel "Next pixel of the overlays" [plain(Key::N)] |app| picture::step_pixel(&mut app.state, true);
    PreviousPixel "Previous pixel of the overlays" [shift(Key::N)] |app| picture::step_pixel(&mut app.state, false);
    Handles "Show or hide handles of points and light" [plain(Key::H)] |app| app.state.open.handles ^= true;
    BoundingBox "Show or hide the box of the scene" [plain(Key::B)] |app| app.state.open.bounding_box ^= true;
    Axes "Show or hide the axes" [] |app| app.state.open.axes ^= true;
    Grid "Show or hide the grid" [] |app| app.state.open.grid ^= true;
    Compare "Compare: wipe, side by side, difference" [shift(Key::Backslash), plain(Key::Pipe)] |app| app.panels.viewport.compare.cycle();
    FlipAb "Switch between the reference and this preset" [plain(Key::Backslash)] |app| app.panels.viewport.compare.flip();
    Trade "Show or hide Trade: time against error" [plain(Key::M)] |app| app.state.open.trade ^= true;
    Timing "Show or hide timing" [plain(Key::G)] |app| app.state.open.timing ^= true;
    Panels "Show or hide panels" [plain(Key::F11)] toggle_panels;
    Timeline "Show or hide the timeline" [plain(Key::T)] |app| app.state.open.timeline ^= true;
    Log "Show or hide the log" [plain(Key::L)] |app| app.state.open.log ^= true;
    Palette "Command palette…" [command(Key::K)] toggle_palette;
    Guide "Guide" [] |app| app.panels.help.show_guide();
    Report "Report a problem…" [] |app| app.panels.help.show_report();
    About "About rasterlab" [] |app| app.panels.help.show_about();
    CheatSheet "Keys and mouse" [plain(Key::F1), plain(Key::Questionmark)] |app| app.state.open.settings ^= true;
    Settings "Settings and keys…" [command(Key::Comma)] |app| app.state.open.settings ^= true;
    ScaleUp "Larger texts and controls" [command(Key::Plus), command(Key::Equals)] |app| app.change_settings(|settings| settings.change_scale(1.0));
    ScaleDown "Smaller texts and controls" [command(Key::Minus)] |app| app.change_settings(|settings| settings.change_scale(-1.0));
    ScaleReset "Texts and controls at 100 %" [command(Key::Num0)] |app| app.change_settings(|settings| settings.scale = 1.0);
}

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
    /// Does what the action says; what it changes is a separate undo step.
    pub fn perform(self, app: &mut App) {
        if !matches!(self, Self::Undo | Self::Redo) {
            app.state.history.close();
        }
        self.run()(app);
    }

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
