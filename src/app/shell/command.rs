//! Commands: everything a panel can ask of the window. A panel reads the state and sends commands;
//! `App` carries them out when the panel has been shown.
//!
//! An [`Action`] is an entry of the table of shortcuts and menu entries; `Command::from` turns it
//! into the command that carries it out. An [`Edit`] is a change of the preset, the payload of
//! [`Command::Edit`].

use std::{cell::RefCell, sync::Arc};

use eframe::egui::KeyboardShortcut;

use super::{action::Action, log::Level};
pub use crate::app::editing::preset_edit::{Edit, Parameter};
use crate::{
    accuracy::{Axis, PinnedOptions},
    app::{
        editing::command::{KeyframeEdit, TimeCommand},
        files::command::{FileCommand, LibraryCommand, Purpose},
        jobs::film,
        picture::{cells::Cells, command::ViewCommand, review::ReviewCommand},
        trade::request::{Progress, Request},
        widgets::theme::ThemeChoice,
    },
    effects::Effect,
};

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
    Review(ReviewCommand),
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
    /// Puts a link to a page that shows the preset on the clipboard.
    CopyLink,
    /// Requests the clipboard's text.
    Paste,
    /// The clipboard's text: a preset, or a value for the row that a menu or the pointer chose.
    PasteText(String),
    /// Gives the value at a path, from text, as `--set` does.
    SetText(String, String),
    /// Shows the effects that can be added, and searches among them.
    AddEffect(String),
    /// Shows the row of this path, or the effect of this name, in the inspector.
    Reveal(String),
    ClearLog,
    Log(Level, String),
    /// Logs a message and shows it as a toast.
    Notify(Level, String),
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
    BoundingBox,
    Axes,
    Grid,
    Palette,
    Settings,
    Extremes,
    Review,
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
        use crate::scene::camera_moves::{FRONT, SIDE, TOP};
        match action {
            Action::Open => Self::File(FileCommand::Ask(Purpose::Open)),
            Action::Save => Self::File(FileCommand::Save),
            Action::SaveAs => Self::File(FileCommand::Ask(Purpose::SaveAs)),
            Action::Export => Self::File(FileCommand::Ask(Purpose::Export)),
            Action::CopyPreset => Self::CopyPreset,
            Action::PastePreset => Self::Paste,
            Action::CopyLink => Self::CopyLink,
            Action::ExportAll => Self::File(FileCommand::ExportAll),
            Action::Quit => Self::Quit,
            Action::Undo => Self::Undo,
            Action::Redo => Self::Redo,
            Action::Randomize => Self::Randomize,
            Action::ForgetRecents => Self::File(FileCommand::ForgetRecents),
            Action::AddEffect => Self::AddEffect(String::new()),
            Action::NewEffect => Self::File(FileCommand::AskNewEffect(None)),
            Action::OpenWithScene => Self::File(FileCommand::OpenWithScene),
            Action::PreviousPreset => Self::File(FileCommand::OpenNeighbor(-1)),
            Action::NextPreset => Self::File(FileCommand::OpenNeighbor(1)),
            Action::Frame => Self::Edit(Edit::FrameScene),
            Action::Front => Self::Edit(Edit::LookAlong(FRONT)),
            Action::Side => Self::Edit(Edit::LookAlong(SIDE)),
            Action::Top => Self::Edit(Edit::LookAlong(TOP)),
            Action::Orthographic => Self::Edit(Edit::ToggleOrthographic),
            Action::AddBookmark => Self::Edit(Edit::AddBookmark),
            Action::NextBookmark => Self::Edit(Edit::NextBookmark),
            Action::Play => Self::Time(TimeCommand::PlayOrPause),
            Action::StepBack => Self::Time(TimeCommand::Step(-1.0)),
            Action::StepForward => Self::Time(TimeCommand::Step(1.0)),
            Action::Rewind => Self::Time(TimeCommand::Rewind),
            Action::RemoveKey => Self::RemoveSelectedKey,
            Action::Verify => Self::Verify,
            Action::Overlays => Self::View(ViewCommand::ToggleOverlays),
            Action::NextPixel => Self::View(ViewCommand::NextPixel),
            Action::PreviousPixel => Self::View(ViewCommand::PreviousPixel),
            Action::Handles => Self::Toggle(Toggle::Handles),
            Action::BoundingBox => Self::Toggle(Toggle::BoundingBox),
            Action::Axes => Self::Toggle(Toggle::Axes),
            Action::Grid => Self::Toggle(Toggle::Grid),
            Action::Compare => Self::View(ViewCommand::CycleCompare),
            Action::FlipAb => Self::View(ViewCommand::FlipCompare),
            Action::Panels => Self::Toggle(Toggle::Panels),
            Action::Timeline => Self::Toggle(Toggle::Timeline),
            Action::Trade => Self::Toggle(Toggle::Trade),
            Action::Timing => Self::Toggle(Toggle::Timing),
            Action::Log => Self::Toggle(Toggle::Log),
            Action::Palette => Self::Toggle(Toggle::Palette),
            Action::Extremes => Self::Toggle(Toggle::Extremes),
            Action::Review => Self::Toggle(Toggle::Review),
            Action::AcceptGolden => Self::Review(ReviewCommand::Accept),
            Action::RejectGolden => Self::Review(ReviewCommand::Reject),
            Action::NextGolden => Self::Review(ReviewCommand::Next),
            Action::RandomizeWindow => Self::Toggle(Toggle::Randomize),
            Action::Sweep => Self::Toggle(Toggle::Sweep),
            Action::Film => Self::Toggle(Toggle::Film),
            Action::CheatSheet | Action::Settings => Self::Toggle(Toggle::Settings),
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
            | Self::Keyframe(
                KeyframeEdit::Ease(..) | KeyframeEdit::Remove(_) | KeyframeEdit::From(_),
            ) => true,
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
