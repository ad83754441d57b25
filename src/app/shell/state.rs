//! The state of the window besides its panels. Panels read it; only `App` changes it.

use glam::DVec3;

use super::log::{Level, Log};
use crate::app::{
    editing::{
        history::History,
        session::{Session, UndoState},
    },
    files::{scene_loader::SceneKey, state::FileState},
    jobs::Jobs,
    picture::{cells::Cells, state::PictureState},
    settings::{OpenPanels, Settings},
};

/// What copy and paste apply to.
#[derive(Clone, Debug, Default)]
pub struct Clipboard {
    /// Path and value of the row under the pointer.
    pub hovered_row: Option<(String, String)>,
    /// Path that the next paste goes to, if the menu of a row requested it.
    pub paste_into: Option<String>,
}

/// How the window closes, and what comes back at the next start.
#[derive(Clone, Copy, Debug)]
pub struct Closing {
    /// The session comes back at the next start.
    pub keeps_session: bool,
    /// The user agreed to quit without saving.
    pub may_quit: bool,
    /// The unsaved edits come back at the next start, although the window closes.
    pub keeps_edits: bool,
}

/// The state of the window besides its panels: the session and its history, and what the subjects
/// of the window keep.
pub struct State {
    pub session: Session,
    pub history: History<UndoState>,
    pub files: FileState,
    pub jobs: Jobs,
    pub picture: PictureState,
    pub clipboard: Clipboard,
    pub log: Log,
    pub open: OpenPanels,
    pub settings: Settings,
    pub closing: Closing,
    /// Time of this frame, seconds since the start.
    pub now_s: f64,
}

impl State {
    /// Logs a message and shows it as a toast.
    pub fn notify(&mut self, level: Level, text: impl Into<String>) {
        self.log.notify(level, text, self.now_s);
    }

    /// Draws small pictures in the background.
    pub fn draw_cells(&self, cells: Cells) {
        let gpu = self.picture.screen.gpu.clone();
        self.jobs.draw_cells(gpu, cells);
    }

    /// The points of the scene that is shown between which a distance is measured.
    pub fn measured_points(&self) -> &[DVec3] {
        let measured = self.picture.measured.as_ref();
        measured
            .filter(|measured| measured.of == SceneKey::of(&self.session.preset_file))
            .map_or(&[][..], |measured| &measured.points[..])
    }

    /// Records the preset for undo; `is_held` while a pointer button is down.
    pub fn observe(&mut self, is_held: bool) {
        self.history
            .observe(&self.session.undo_state(), self.now_s, is_held);
    }
}
