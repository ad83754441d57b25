//! Commands: everything a panel can ask of the window. A panel reads the state and sends commands; `App` carries them
//! out when the panel has been shown.
//!
//! An [`Action`] is an entry of the table of shortcuts and menu entries; `Command::from` turns it into the command that carries it
//! out. An [`Edit`] is a change of the preset, the payload of [`Command::Edit`].

use std::{cell::RefCell, path::PathBuf, sync::Arc};

use super::{
    action::Action,
    cells::Cells,
    favorites::Starred,
    film,
    key_id::KeyId,
    log::Level,
    overlay::Overlay,
    screen::Inputs,
    settings::last_session::Restored,
    theme::ThemeChoice,
    trade::request::{Progress, Request},
};
use crate::{
    accuracy::{Axis, PinnedOptions},
    effect_files::Hook,
    effects::Effect,
    preset::animation::Easing,
    preset_file::PresetFile,
    scene::parts::PartKind,
};
use eframe::egui::KeyboardShortcut;

pub use super::preset_edit::{Edit, Parameter};

/// What a click on the model sets.
#[derive(Clone, Debug, PartialEq)]
pub enum Picking {
    /// A point.
    Point(Parameter),
    /// A part of this kind that the effect changes.
    Part(Arc<Effect>, PartKind),
}

impl Picking {
    pub fn effect(&self) -> &Arc<Effect> {
        match self {
            Self::Point((effect, _)) | Self::Part(effect, _) => effect,
        }
    }
}

/// What a panel, a shortcut or a dropped file asks the window to do.
pub enum Command {
    /// Does what a key or a menu entry does, as a separate undo step.
    Perform(Action),
    Undo,
    Redo,
    Quit,
    Edit(Edit),
    /// Gives every parameter of the enabled effects that is not locked a random value.
    Randomize,
    /// How far random values may go from where they are, in percent of the soft range.
    VaryBy(f64),
    /// Keeps a parameter as it is when the effects are randomized, or lets it vary.
    Lock(Parameter, bool),
    /// Goes back to the values that a seed gave.
    RecallSeed(u32),
    /// Sets values by their paths, as a separate undo step.
    SetValues(Vec<(String, String)>),
    /// Draws small pictures in the background.
    DrawCells(Cells),
    Keyframe(KeyframeEdit),
    /// Removes the keyframe that is selected on the timeline.
    RemoveSelectedKey,
    Time(TimeCommand),
    Row(RowCommand),
    File(FileCommand),
    View(ViewCommand),
    /// Measures every combination of the options of the request's axes.
    MeasureTrade(Box<Request>, Arc<Progress>),
    /// Somebody looks at what the accuracy tiers cost.
    MeasureTiers,
    /// Draws the film of the preset and writes it.
    ExportFilm(Box<film::Request>, Arc<film::Progress>),
    /// Pins the options of these axes, as a separate undo step.
    PinOptions(PinnedOptions, Vec<&'static Axis>),
    Toggle(Toggle),
    Settings(SettingsCommand),
    Library(LibraryCommand),
    /// Starts the oracle on the picture that is shown, and on the one it is compared with.
    Verify,
    /// Ends the judgements under way.
    CancelVerify,
    /// Stops loading a scene.
    CancelLoading,
    /// Hides an effect (true) or shows it again. Muting is a viewing aid and is not saved.
    Mute(Arc<Effect>, bool),
    /// The pointer is over the row of this parameter or setting: copy and paste apply to its value.
    HoverRow {
        path: String,
        value: String,
    },
    /// Puts the preset on the clipboard.
    CopyPreset,
    /// Requests the clipboard's text.
    Paste,
    /// The clipboard's text: a preset, or a value for the row that a menu or the pointer chose.
    PasteText(String),
    /// Gives the value at a path, from text, as `--set` does.
    SetText(String, String),
    /// Shows the row of this path, or the effect of this name, in the inspector.
    Reveal(String),
    ClearLog,
    Log(Level, String),
    /// Logs a message and shows it as a toast.
    Notify(Level, String),
}

/// A change of the keyframes of an animated parameter.
pub enum KeyframeEdit {
    Move(KeyId, f64),
    Ease(KeyId, Easing),
    Remove(KeyId),
}

/// A change of the time that is shown. Seconds.
pub enum TimeCommand {
    Show(f64),
    /// Goes to `clock.time_s`.
    ShowOwn,
    /// Writes the shown time to `clock.time_s`.
    Keep,
    PlayOrPause,
    Pause,
    /// Frames to step by, negative for back.
    Step(f64),
    Rewind,
    /// True while the pointer holds the playhead: playing does not advance the time.
    Hold(bool),
}

/// What a row of the inspector does besides changing its value.
#[derive(Clone, Debug, PartialEq)]
pub enum RowCommand {
    Reset(String),
    /// Resets everything of the same effect or table.
    ResetGroup(String),
    /// Puts this text on the clipboard.
    Copy(String),
    /// Pastes into this path.
    Paste(String),
    /// Sets a keyframe of this parameter at the time shown, or removes the one that is there.
    ToggleKey(String),
}

/// What a file dialog is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Open,
    SaveAs,
    Export,
}

/// Whose changes of a preset stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Mine,
    Theirs,
    /// Both, key by key; mine where both have changed the same.
    Both,
}

/// What becomes of the scene that is shown when something is opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// The preset brings its own scene.
    WithScene,
    /// Its look lands on the user's own scene, if there is one.
    Look,
    /// A model or built-in scene that is chosen: it takes the look that is shown.
    Scene,
}

/// What happens to a preset that brings effects when the user has decided about them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CodeUse {
    /// It is opened, and this is said.
    Open(Manner, String),
    /// It replaces the open preset, whose file has changed.
    Reload,
}

/// What a new effect begins as.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A commented template.
    Template(Hook),
    /// The text of another effect, which it replaces in the stack.
    Duplicate(Arc<Effect>),
}

pub enum FileCommand {
    /// Shows the dialog for this purpose.
    Ask(Purpose),
    /// Shows the system's file dialog, beginning at this path.
    Browse(Purpose, PathBuf),
    /// Opens a preset, model or picture by path, id or `builtin:QUERY`, or enables the effect of a file.
    Open(String),
    OpenPreset(Box<PresetFile>, Manner),
    /// Opens the preset whose look is shown on the user's own scene, with its scene.
    OpenWithScene,
    /// Opens the preset this many entries further in the gallery, wrapping round.
    OpenNeighbor(isize),
    /// Saves to the preset's own file, or asks for one.
    Save,
    /// Saves there; asks first if effects are muted.
    SaveTo(PathBuf),
    /// Saves there, without the muted effects if `drops_muted`.
    Write {
        path: PathBuf,
        drops_muted: bool,
    },
    /// Draws the picture at this size and saves it as a PNG.
    Export {
        path: PathBuf,
        size: [u32; 2],
    },
    /// Asks for the name of a new effect, and for its hook unless it duplicates another effect.
    AskNewEffect(Option<Arc<Effect>>),
    /// Writes a new effect for the user to change, and enables it.
    NewEffect {
        name: String,
        origin: Origin,
    },
    /// Opens a file in the user's editor.
    Edit(PathBuf),
    /// Decides between the open preset and what another program has made of its file. The outcome is saved to `saving`, if that led to the
    /// question.
    Resolve {
        theirs: Box<PresetFile>,
        side: Side,
        saving: Option<PathBuf>,
    },
    /// Goes on with a preset that brings effects, now that the user has decided whether they run.
    UseCode {
        preset_file: Box<PresetFile>,
        then: CodeUse,
        runs: bool,
    },
    /// Closes the window without saving; the edits may come back at the next start.
    Quit {
        keeps_edits: bool,
    },
    /// Reads what is in a folder.
    List(PathBuf),
    /// Opens what was open in the last session.
    Restore(Box<Restored>),
    /// Forgets the recent files.
    ForgetRecents,
}

/// What a name is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Naming {
    /// Another name for the preset of this file.
    Preset { path: PathBuf, title: String },
    /// A name for the present values of this effect.
    Values(Arc<Effect>),
}

/// Favorites, files of presets, and values of effects.
pub enum LibraryCommand {
    /// Makes the preset of this id, or the effect of this name, a favorite (true), or takes its star away.
    Star(Starred, String, bool),
    AskName(Naming),
    /// Uses the name that was asked for.
    Name(Naming, String),
    /// Writes a copy of the preset, as its file has it.
    Duplicate(Box<PresetFile>),
    /// Moves the preset at this path to the trash.
    Delete(PathBuf),
    /// Puts the preset that was deleted last back.
    Restore,
    /// What was deleted stays in the trash.
    ForgetDeleted,
    /// Puts the effect with its values on the clipboard.
    CopyEffect(Arc<Effect>),
    /// Gives an effect the values of this file.
    UseValues(PathBuf),
    /// Moves this file of values to the trash.
    DeleteValues(PathBuf),
}

/// A place in a picture.
#[derive(Clone, Debug)]
pub struct Marker {
    /// The picture; in another one the place is not marked.
    pub of: Inputs,
    /// As a fraction of the picture's width and height.
    pub uv: [f32; 2],
    /// What is there.
    pub text: String,
}

pub enum ViewCommand {
    ToggleOverlays,
    ShowOverlay(Overlay, bool),
    OverlayGain(u8),
    CycleCompare,
    FlipCompare,
    /// What the next click on the model sets; none cancels.
    Pick(Option<Picking>),
    /// Marks a place in the picture; none removes the mark.
    Mark(Option<Box<Marker>>),
}

/// What can be shown or hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Toggle {
    /// The side panels and the timeline.
    Panels,
    Timeline,
    Trade,
    Timing,
    Log,
    /// The rings in the picture, and the ball of the light.
    Handles,
    CheatSheet,
    Palette,
    Settings,
    Extremes,
    Randomize,
    Sweep,
    Film,
}

/// A change of the window's settings.
#[derive(Clone, Debug, PartialEq)]
pub enum SettingsCommand {
    Theme(ThemeChoice),
    /// Makes texts and controls larger by this many steps, or smaller.
    Scale(f32),
    ResetScale,
    /// Makes this the only shortcut of the action; none takes its shortcuts away.
    Bind(Action, Option<KeyboardShortcut>),
    /// Gives the action its own shortcuts again.
    ResetKeys(Action),
    ResetAllKeys,
}

impl From<Action> for Command {
    fn from(action: Action) -> Self {
        use super::orbit::{FRONT, SIDE, TOP};
        match action {
            Action::Open => Self::File(FileCommand::Ask(Purpose::Open)),
            Action::Save => Self::File(FileCommand::Save),
            Action::SaveAs => Self::File(FileCommand::Ask(Purpose::SaveAs)),
            Action::Export => Self::File(FileCommand::Ask(Purpose::Export)),
            Action::CopyPreset => Self::CopyPreset,
            Action::PastePreset => Self::Paste,
            Action::Quit => Self::Quit,
            Action::Undo => Self::Undo,
            Action::Redo => Self::Redo,
            Action::Randomize => Self::Randomize,
            Action::OpenWithScene => Self::File(FileCommand::OpenWithScene),
            Action::PreviousPreset => Self::File(FileCommand::OpenNeighbor(-1)),
            Action::NextPreset => Self::File(FileCommand::OpenNeighbor(1)),
            Action::Frame => Self::Edit(Edit::FrameScene),
            Action::Front => Self::Edit(Edit::LookAlong(FRONT)),
            Action::Side => Self::Edit(Edit::LookAlong(SIDE)),
            Action::Top => Self::Edit(Edit::LookAlong(TOP)),
            Action::Orthographic => Self::Edit(Edit::ToggleOrthographic),
            Action::Play => Self::Time(TimeCommand::PlayOrPause),
            Action::StepBack => Self::Time(TimeCommand::Step(-1.0)),
            Action::StepForward => Self::Time(TimeCommand::Step(1.0)),
            Action::Rewind => Self::Time(TimeCommand::Rewind),
            Action::RemoveKey => Self::RemoveSelectedKey,
            Action::Verify => Self::Verify,
            Action::Overlays => Self::View(ViewCommand::ToggleOverlays),
            Action::Handles => Self::Toggle(Toggle::Handles),
            Action::Compare => Self::View(ViewCommand::CycleCompare),
            Action::FlipAb => Self::View(ViewCommand::FlipCompare),
            Action::Panels => Self::Toggle(Toggle::Panels),
            Action::Timeline => Self::Toggle(Toggle::Timeline),
            Action::Trade => Self::Toggle(Toggle::Trade),
            Action::Timing => Self::Toggle(Toggle::Timing),
            Action::Log => Self::Toggle(Toggle::Log),
            Action::Palette => Self::Toggle(Toggle::Palette),
            Action::CheatSheet => Self::Toggle(Toggle::CheatSheet),
            Action::Extremes => Self::Toggle(Toggle::Extremes),
            Action::RandomizeWindow => Self::Toggle(Toggle::Randomize),
            Action::Sweep => Self::Toggle(Toggle::Sweep),
            Action::Film => Self::Toggle(Toggle::Film),
            Action::Settings => Self::Toggle(Toggle::Settings),
            Action::ScaleUp => Self::Settings(SettingsCommand::Scale(1.0)),
            Action::ScaleDown => Self::Settings(SettingsCommand::Scale(-1.0)),
            Action::ScaleReset => Self::Settings(SettingsCommand::ResetScale),
        }
    }
}

impl Command {
    /// Does it end the undo step before it? Drags send edits in every frame and do not.
    pub fn begins_step(&self) -> bool {
        match self {
            Self::Perform(action) => !matches!(action, Action::Undo | Action::Redo),
            Self::Row(_)
            | Self::RecallSeed(_)
            | Self::SetValues(_)
            | Self::SetText(..)
            | Self::PinOptions(..)
            | Self::Keyframe(KeyframeEdit::Ease(..) | KeyframeEdit::Remove(_)) => true,
            _ => false,
        }
    }
}

/// The commands that panels have sent and that wait to be carried out.
#[derive(Default)]
pub struct Commands(RefCell<Vec<Command>>);

impl Commands {
    pub fn send(&self, command: Command) {
        self.0.borrow_mut().push(command);
    }

    pub fn edit(&self, edit: Edit) {
        self.send(Command::Edit(edit));
    }

    pub fn perform(&self, action: Action) {
        self.send(Command::Perform(action));
    }

    /// Those sent since the last call, in order.
    pub fn take(&self) -> Vec<Command> {
        self.0.take()
    }
}
