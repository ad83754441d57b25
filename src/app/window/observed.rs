//! What tests read of the window, and how they hold it.

use std::sync::Arc;

use super::app::App;
use crate::{
    accuracy::RenderScale,
    app::{
        panels::Panels,
        picture::{
            state::PictureState,
            tier_times::{self, TierTime},
            timings::Occasion,
        },
        shell::state::State,
    },
    gpu::Gpu,
    measure::ErrorReport,
    plan::Tier,
    preset::Preset,
    preset_file::PresetFile,
    scene::view::View,
};

impl App {
    /// The open preset with its file.
    pub fn preset_file(&self) -> &PresetFile {
        &self.state.session.preset_file
    }

    /// The open preset, to be changed as a panel would change it.
    pub fn preset_mut(&mut self) -> &mut Preset {
        self.state.session.preset_mut()
    }

    /// The time that is shown, seconds.
    pub fn shown_time_s(&self) -> f64 {
        self.state.session.shown_time_s()
    }

    /// Frames drawn so far; unchanged while nothing changes.
    pub fn draws(&self) -> u64 {
        self.state.picture.screen.draws()
    }

    /// Times of the newest frames that were drawn again to be measured, oldest first, milliseconds.
    pub fn measured_ms(&self) -> Vec<f64> {
        let frames = self.state.picture.screen.timings().history();
        frames
            .filter(|(_, occasion)| *occasion == Occasion::Rest)
            .map(|(sample, _)| sample.ms)
            .collect()
    }

    /// Triangles of the scene that is shown; 0 without one.
    pub fn scene_triangles(&self) -> u64 {
        self.state
            .session
            .scene()
            .map_or(0, |scene| scene.triangle_count())
    }

    /// Number of steps that undo can take back.
    pub fn undo_steps(&self) -> usize {
        self.state.history.steps()
    }

    /// True if the picture shows the preset and nothing is still to come.
    pub fn is_idle(&self) -> bool {
        let State {
            session,
            picture:
                PictureState {
                    screen,
                    verification,
                    ..
                },
            ..
        } = &self.state;
        let Panels {
            viewport,
            trade,
            browser,
            film,
            ..
        } = &self.panels;
        let is_playing = session.playback.playing;
        let is_loaded = !self.state.files.opening.is_waiting()
            && !session.scenes.is_loading()
            && session.scene().is_some();
        let is_shown = !screen.is_awaited(is_playing) && !viewport.compare.is_awaited(is_playing);
        let is_judged = !verification.is_running() && self.state.picture.overlays_are_ready();
        let is_measured =
            is_playing || !(screen.needs_measuring() || viewport.compare.needs_measuring());
        is_loaded
            && is_shown
            && is_judged
            && is_measured
            && !self.state.picture.precision.is_running()
            && !self.state.files.live.is_busy()
            && !trade.is_measuring()
            && !film.is_exporting()
            && !browser.is_busy()
            && !self.state.files.favorites.is_busy()
            && !self.panels.randomize.is_drawing()
            && !self.panels.sweep.is_drawing()
    }

    /// What is compiled for the picture, as the window shows it; none while nothing is.
    pub fn compiling(&self) -> Option<String> {
        self.state.picture.screen.compiling()
    }

    /// Holds the thread of the picture when it is next about to compile, or lets it go on.
    pub fn hold_compiling(&mut self, is_held: bool) {
        self.state.picture.screen.hold_compiling(is_held);
    }

    /// True if there is a picture, even one of an earlier preset.
    pub fn has_picture(&self) -> bool {
        self.state.picture.screen.picture().is_some()
    }

    /// The log as text.
    pub fn log_text(&self) -> String {
        self.state.log.to_text()
    }

    /// The view that a picture of `size` pixels shows; none while there is no scene.
    pub fn view(&self, size: [u32; 2]) -> Option<View> {
        self.state
            .session
            .scene()
            .map(|scene| self.state.session.view_at(scene, size))
    }

    /// Width and height in pixels of the picture that was asked for last; none before the first.
    pub fn ordered_size(&self) -> Option<[u32; 2]> {
        self.state.picture.screen.ordered_size()
    }

    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.state.picture.screen.gpu
    }

    /// How many pixels are drawn for one that is shown, with automatic anti-aliasing; none before
    /// the first picture.
    pub fn drawn_scale(&self) -> Option<RenderScale> {
        self.state
            .picture
            .screen
            .requested()
            .map(|inputs| inputs.accuracy.scale())
    }

    /// Measured milliseconds of the open picture in a tier; none while they are not measured.
    pub fn tier_ms(&self, tier: Tier) -> Option<f64> {
        match tier_times::numbers(&self.state, tier)?.time {
            TierTime::Ms(ms) => Some(ms),
            TierTime::NotYet | TierTime::Failed => None,
        }
    }

    /// The measured error of the picture that is drawn; none if it was not measured.
    pub fn accuracy(&self) -> Option<&ErrorReport> {
        self.state.picture.accuracy()
    }

    /// Position of the comparison's divider, as a fraction of the picture's width; none unless the
    /// wipe is open.
    pub fn wipe_split(&self) -> Option<f32> {
        self.panels.viewport.compare.wipe_split()
    }

    /// Number of pictures of the newest sweep that are drawn.
    pub fn sweep_pictures(&self) -> usize {
        self.panels.sweep.pictures()
    }

    /// Is the panel Trade open?
    pub fn is_trade_open(&self) -> bool {
        self.state.open.trade
    }

    /// Number of points of the newest measurement of the panel Trade.
    pub fn trade_points(&self) -> usize {
        self.panels.trade.points()
    }

    /// True while a toast lies over the picture.
    pub fn shows_toasts(&self) -> bool {
        self.state
            .log
            .next_toast_ends_in_s(self.state.now_s)
            .is_some()
    }
}
