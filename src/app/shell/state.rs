//! The state of the window besides its panels: the session, its history, the picture, and what several panels share.
//! Panels read it; only `App` changes it.

use std::{collections::HashSet, path::PathBuf, sync::Arc};

use super::{
    command::{Marker, Picking},
    log::{Level, Log},
};
use crate::app::{
    editing::{
        history::History,
        session::{Session, UndoState},
        trust::Trust,
    },
    files::{deleted::Deleted, favorites::Favorites, live::Live, opening::Opening},
    jobs::Jobs,
    picture::{
        findings::Findings, overlay::OverlaySelection, precision::PrecisionState, screen::Screen, tier_times::TierTimes,
        verification::Verification,
    },
    settings::{OpenPanels, Settings},
};
use crate::{
    measure::ErrorReport,
    preset_file::{Folders, SavedValues},
};

/// What copy and paste apply to.
#[derive(Clone, Debug, Default)]
pub struct Clipboard {
    /// Path and value of the row under the pointer.
    pub hovered_row: Option<(String, String)>,
    /// Path that the next paste goes to, if the menu of a row requested it.
    pub paste_into: Option<String>,
}

/// The state of the window besides its panels: the session, its history, the picture, and what several panels share.
pub struct State {
    /// Where presets and effects are, beside the user's own presets.
    pub folders: Folders,
    /// What is watched on disk.
    pub live: Live,
    /// Effects that came inside presets and may run.
    pub trust: Trust,
    pub session: Session,
    pub favorites: Favorites,
    /// Files that were moved to the trash since the start, the newest last.
    pub deleted: Vec<Deleted>,
    /// Saved values of effects.
    pub values: Vec<SavedValues>,
    pub history: History<UndoState>,
    /// The preset that is being opened.
    pub opening: Opening,
    pub jobs: Jobs,
    /// What the accuracy tiers cost. Dropped before the screen, which waits for its thread.
    pub tier_times: TierTimes,
    pub screen: Screen,
    pub verification: Verification,
    pub overlays: OverlaySelection,
    /// The f32 errors of the user's effects.
    pub precision: PrecisionState,
    /// The place in the picture that is marked.
    pub marker: Option<Marker>,
    /// What the next click on the model sets.
    pub picking: Option<Picking>,
    pub clipboard: Clipboard,
    pub log: Log,
    pub open: OpenPanels,
    pub settings: Settings,
    /// Recent files that are not there.
    pub missing_files: HashSet<PathBuf>,
    /// The session comes back at the next start.
    pub keeps_session: bool,
    /// The user agreed to quit without saving.
    pub may_quit: bool,
    /// The unsaved edits come back at the next start, although the window closes.
    pub keeps_edits: bool,
    /// Time of this frame, seconds since the start.
    pub now_s: f64,
}

impl State {
    /// The verdict on the picture that is drawn, as numbers.
    pub fn accuracy(&self) -> Option<&ErrorReport> {
        self.verification.verdict_on(self.screen.drawn()).map(|verdict| &verdict.findings.accuracy)
    }

    /// The verdict on the requested picture, pixel by pixel.
    pub fn findings(&self) -> Option<&Arc<Findings>> {
        self.verification.verdict_on(self.screen.requested()).map(|verdict| &verdict.findings)
    }

    /// False while overlays are shown and the picture has not been judged.
    pub fn overlays_are_ready(&self) -> bool {
        !self.overlays.is_any() || self.findings().is_some() || self.verification.has_failed(self.screen.requested())
    }

    /// Logs a message and shows it as a toast.
    pub fn notify(&mut self, level: Level, text: impl Into<String>) {
        self.log.notify(level, text, self.now_s);
    }

    /// Records the preset for undo; `is_held` while a pointer button is down.
    pub fn observe(&mut self, is_held: bool) {
        self.history.observe(&self.session.undo_state(), self.now_s, is_held);
    }
}
