//! Commands: what panels ask of the window. A panel reads the state and sends closures on the whole
//! window, which are run when the panel has been shown.

use std::cell::RefCell;

use super::{action::Action, log::Level};
pub use crate::app::editing::preset_edit::{Edit, Parameter};
use crate::app::{App, editing::apply::row, files::apply::open_named};

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

/// A change of the window that a panel has asked for.
pub type Command = Box<dyn FnOnce(&mut App)>;

/// The commands that panels have sent and that wait to be run.
#[derive(Default)]
pub struct Commands(RefCell<Vec<Command>>);

impl Commands {
    /// Has `command` run when the panel has been shown.
    pub fn send(&self, command: Command) {
        self.0.borrow_mut().push(command);
    }

    /// Has `command` run when the panel has been shown. Drags send edits in every frame, which are
    /// one undo step.
    pub fn run(&self, command: impl FnOnce(&mut App) + 'static) {
        self.send(Box::new(command));
    }

    /// The same, as a separate undo step.
    pub fn step(&self, command: impl FnOnce(&mut App) + 'static) {
        self.run(|app| {
            app.state.history.close();
            command(app);
        });
    }

    pub fn edit(&self, edit: Edit) {
        self.run(|app| app.edit(edit));
    }

    /// Does what a key or a menu entry does, as a separate undo step.
    pub fn perform(&self, action: Action) {
        self.run(move |app| action.perform(app));
    }

    pub fn row(&self, command: RowCommand) {
        self.step(|app| row(app, command));
    }

    /// Opens a preset, model or picture by path, id or `builtin:QUERY`, or enables the effect of a
    /// file.
    pub fn open(&self, what: String) {
        self.run(move |app| open_named(app, &what));
    }

    /// Shows the row of this path, or the effect of this name, in the inspector.
    pub fn reveal(&self, path: String) {
        self.run(|app| app.reveal(path));
    }

    /// Logs a message and shows it as a toast.
    pub fn notify(&self, level: Level, text: impl Into<String>) {
        let text = text.into();
        self.run(move |app| app.notify(level, text));
    }

    /// Those sent since the last call, in order.
    pub fn take(&self) -> Vec<Command> {
        self.0.take()
    }
}
