//! The panels of the window. Each owns its state, reads that of the window, and sends commands.

pub mod brought_code;
pub mod cheat_sheet;
pub mod dialogs;
pub mod extremes;
pub mod inspector;
pub mod log;
pub mod new_effect;
pub mod preset_browser;
pub mod sweep;
pub mod timeline;
pub mod timing;
pub mod topbar;
pub mod viewport;

use self::{
    cheat_sheet::CheatSheet, dialogs::Dialogs, extremes::Extremes, inspector::Inspector, log::LogPanel, preset_browser::PresetBrowser,
    sweep::SweepPanel, timeline::Timeline, timing::TimingPanel, topbar::TopBar, viewport::Viewport,
};
use crate::preset_file::Folders;

/// All panels.
pub struct Panels {
    pub topbar: TopBar,
    pub browser: PresetBrowser,
    pub inspector: Inspector,
    pub timeline: Timeline,
    pub sweep: SweepPanel,
    pub timing: TimingPanel,
    pub log: LogPanel,
    pub viewport: Viewport,
    pub dialogs: Dialogs,
    pub cheat_sheet: CheatSheet,
    pub extremes: Extremes,
}

impl Panels {
    /// The panels at the start, with the presets of `folders` in the gallery.
    pub fn new(folders: &Folders) -> Self {
        Self {
            topbar: TopBar,
            browser: PresetBrowser::new(folders),
            inspector: Inspector,
            timeline: Timeline::default(),
            sweep: SweepPanel::default(),
            timing: TimingPanel,
            log: LogPanel,
            viewport: Viewport::default(),
            dialogs: Dialogs::default(),
            cheat_sheet: CheatSheet::default(),
            extremes: Extremes::default(),
        }
    }
}
