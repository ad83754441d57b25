//! What the window remembers between runs: its settings (`settings.toml`) and its last session (`session.toml`), both in the folder of the
//! user's configuration.

pub mod browsing;
mod change;
pub mod film;
pub mod keeper;
pub mod keymap;
pub mod last_session;
pub mod recents;
mod toml;
mod writer;

use eframe::egui;

use self::{browsing::Browsing, film::FilmSettings, keymap::Keymap, recents::Recents};
use super::theme::ThemeChoice;

/// Sizes of texts and controls that can be chosen, as a factor of the system's.
pub const SCALES: [f32; 2] = [0.5, 3.0];

/// A step of the scale.
pub const SCALE_STEP: f32 = 0.1;

/// Size of the window's contents that can be restored, points.
const WINDOW_SIZES: [f32; 2] = [200.0, 16384.0];

/// Width of a side panel that can be restored, points.
const PANEL_WIDTHS: [f32; 2] = [100.0, 2000.0];

/// What the window remembers of how the user works.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    pub theme: ThemeChoice,
    /// Size of texts and controls, as a factor of the system's.
    pub scale: f32,
    pub recents: Recents,
    pub keys: Keymap,
    pub window: WindowPlace,
    pub open: OpenPanels,
    /// Widths of the side panels, points: left and right; none before they were shown.
    pub widths: [Option<f32>; 2],
    /// What the left panel shows, and how.
    pub browsing: Browsing,
    /// How the last film was exported.
    pub film: FilmSettings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::default(),
            scale: 1.0,
            recents: Recents::default(),
            keys: Keymap::default(),
            window: WindowPlace::default(),
            open: OpenPanels::default(),
            widths: [None; 2],
            browsing: Browsing::default(),
            film: FilmSettings::default(),
        }
    }
}

impl Settings {
    /// Makes texts and controls larger by `steps`, or smaller.
    pub fn change_scale(&mut self, steps: f32) {
        let scale = (self.scale / SCALE_STEP).round() + steps;
        self.scale = (scale * SCALE_STEP).clamp(SCALES[0], SCALES[1]);
    }
}

impl Settings {
    /// Widths of the left and the right panel in a window of this width, points.
    pub fn panel_widths(&self, window: f32) -> [f32; 2] {
        let usual = if window < NARROW { NARROW_WIDTHS } else { WIDTHS };
        std::array::from_fn(|side| self.widths[side].unwrap_or(usual[side]))
    }

    /// Remembers the width of the left (0) or right (1) panel that was and is open; one that opens or closes is narrower.
    /// A width that nobody has changed is not remembered.
    pub fn keep_width(&mut self, side: usize, is_open: bool, rect: Option<egui::Rect>, window: f32) {
        let usual = self.panel_widths(window)[side];
        if let Some(width) = rect.map(|rect| rect.width().round()).filter(|width| is_open && *width >= MIN_KEPT)
            && (width - usual).abs() > 1.5
        {
            self.widths[side] = Some(width);
        }
    }
}

/// Widths of the side panels unless the user has changed them, and the least that is remembered, points.
const WIDTHS: [f32; 2] = [264.0, 344.0];
const NARROW: f32 = 1080.0;
const NARROW_WIDTHS: [f32; 2] = [216.0, 316.0];
const MIN_KEPT: f32 = 190.0;

/// Which panels, windows and handles are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenPanels {
    pub left: bool,
    pub right: bool,
    pub timeline: bool,
    pub trade: bool,
    pub timing: bool,
    pub log: bool,
    /// The rings in the picture, and the ball of the light.
    pub handles: bool,
    pub cheat_sheet: bool,
    pub settings: bool,
}

impl Default for OpenPanels {
    fn default() -> Self {
        Self {
            left: true,
            right: true,
            timeline: true,
            trade: false,
            timing: false,
            log: false,
            handles: true,
            cheat_sheet: false,
            settings: false,
        }
    }
}

/// Size of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowPlace {
    /// Width and height of its contents at a scale of 1, points.
    pub size: [f32; 2],
    pub is_maximized: bool,
}

impl Default for WindowPlace {
    fn default() -> Self {
        Self { size: [1280.0, 800.0], is_maximized: false }
    }
}

impl WindowPlace {
    /// Takes the size of the window while it is neither maximized nor minimized.
    pub fn follow(&mut self, viewport: &egui::ViewportInfo, scale: f32) {
        self.is_maximized = viewport.maximized.unwrap_or(self.is_maximized);
        let is_free = !self.is_maximized && viewport.fullscreen != Some(true) && viewport.minimized != Some(true);
        if let Some(rect) = viewport.inner_rect.filter(|_| is_free) {
            let size = [rect.width(), rect.height()].map(|side| (side * scale).round());
            if size.iter().all(|side| (WINDOW_SIZES[0]..=WINDOW_SIZES[1]).contains(side)) {
                self.size = size;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_goes_in_tenths_and_stays_in_its_range() {
        let mut settings = Settings::default();
        settings.change_scale(1.0);
        assert!((settings.scale - 1.1).abs() < 1e-6);
        settings.change_scale(100.0);
        assert_eq!(settings.scale, SCALES[1]);
        settings.change_scale(-100.0);
        assert_eq!(settings.scale, SCALES[0]);
    }
}
