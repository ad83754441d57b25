//! The panels of the window. Each owns its state, reads that of the window, and sends commands.

pub mod anti_aliasing;
pub mod brought_code;
pub mod code;
pub mod dialogs;
pub mod effect_browser;
pub mod extremes;
pub mod film;
pub mod help;
pub mod inspector;
pub mod log;
pub mod naming;
pub mod new_effect;
pub mod palette;
pub mod panel;
pub mod preset_browser;
pub mod randomize;
pub mod review;
pub mod settings;
pub mod sweep;
pub mod timeline;
pub mod timing;
pub mod topbar;
pub mod trade;
pub mod viewport;

use self::{
    code::CodePanel, dialogs::Dialogs, extremes::Extremes, film::FilmPanel, help::HelpWindow,
    inspector::Inspector, log::LogPanel, naming::NameDialog, palette::Palette,
    preset_browser::PresetBrowser, randomize::RandomizePanel, review::ReviewPanel,
    settings::SettingsWindow, sweep::SweepPanel, timeline::Timeline, timing::TimingPanel,
    topbar::TopBar, trade::TradePanel, viewport::Viewport,
};
use crate::preset_file::Folders;

/// All panels.
pub struct Panels {
    pub topbar: TopBar,
    pub browser: PresetBrowser,
    pub inspector: Inspector,
    pub timeline: Timeline,
    pub trade: TradePanel,
    pub timing: TimingPanel,
    pub log: LogPanel,
    pub viewport: Viewport,
    pub dialogs: Dialogs,
    pub settings: SettingsWindow,
    pub extremes: Extremes,
    pub review: ReviewPanel,
    pub randomize: RandomizePanel,
    pub sweep: SweepPanel,
    pub film: FilmPanel,
    pub help: HelpWindow,
    pub palette: Palette,
    pub naming: NameDialog,
    pub code: CodePanel,
}

impl Panels {
    /// True while a dialog takes all keys.
    pub fn has_dialog(&self) -> bool {
        self.dialogs.is_open()
            || self.palette.is_open()
            || self.naming.is_open()
            || self.browser.effects.is_adding()
    }

    /// True while a dialog with a field for text is open.
    pub fn takes_text(&self) -> bool {
        self.dialogs.takes_text()
            || self.palette.is_open()
            || self.naming.is_open()
            || self.browser.effects.is_adding()
    }

    /// The panels at the start, with the presets of `folders` in the gallery.
    pub fn new(folders: &Folders) -> Self {
        Self {
            topbar: TopBar,
            browser: PresetBrowser::new(folders),
            inspector: Inspector,
            timeline: Timeline::default(),
            trade: TradePanel::default(),
            timing: TimingPanel,
            log: LogPanel,
            viewport: Viewport::default(),
            dialogs: Dialogs::default(),
            settings: SettingsWindow::default(),
            extremes: Extremes::default(),
            review: ReviewPanel::default(),
            randomize: RandomizePanel::default(),
            sweep: SweepPanel::default(),
            film: FilmPanel::default(),
            help: HelpWindow::default(),
            palette: Palette::default(),
            naming: NameDialog::default(),
            code: CodePanel::default(),
        }
    }
}
