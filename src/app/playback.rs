//! Playback: where the hand of the clock stands while the preset is shown. No part of the preset, so undo does not see it.

use eframe::egui;

use super::{App, Level};
use crate::{
    effects::{Effect, Stack},
    params::Field,
    preset::{Preset, animation::MAX_TIME_S},
};

/// A step in time, seconds.
pub const STEP_S: f64 = 1.0 / 30.0;

/// A frame that took longer counts as this long, so that a hiccup is no jump.
const LONGEST_S: f64 = 0.25;

#[derive(Default)]
pub struct Playback {
    pub playing: bool,
    /// A hand holds the clock: it does not run on by itself.
    pub held: bool,
    /// The moment that is shown, where it is not the preset's own.
    at_s: Option<f64>,
}

impl App {
    /// The moment that is shown, seconds.
    pub fn shown_time_s(&self) -> f64 {
        self.playback.at_s.unwrap_or(self.preset_file.preset.clock.time_s)
    }

    /// Is another moment shown than the preset's own?
    pub(super) fn is_off_its_time(&self) -> bool {
        self.shown_time_s() != self.preset_file.preset.clock.time_s
    }

    /// Shows another moment.
    pub(super) fn show_time(&mut self, time_s: f64) {
        if time_s.is_finite() {
            self.playback.at_s = Some(time_s.clamp(-MAX_TIME_S, MAX_TIME_S));
        }
    }

    /// Shows the preset's own time.
    pub(super) fn show_own_time(&mut self) {
        self.playback.at_s = None;
    }

    /// Makes the moment that is shown the preset's own.
    pub(super) fn keep_time(&mut self) {
        self.preset_file.preset.clock.time_s = self.shown_time_s();
        self.playback.at_s = None;
    }

    /// Lets time run.
    pub(super) fn play(&mut self, ctx: &egui::Context) {
        if !self.playback.playing {
            return;
        }
        ctx.request_repaint();
        if !self.playback.held {
            let passed_s = f64::from(ctx.input(|i| i.stable_dt)).min(LONGEST_S);
            let (time_s, goes_on) = self.preset_file.preset.clock.after(self.shown_time_s(), passed_s);
            self.show_time(time_s);
            self.playback.playing = goes_on;
        }
    }

    pub(super) fn play_or_pause(&mut self) {
        self.playback.playing = !self.playback.playing;
        let clock = self.preset_file.preset.clock;
        if self.playback.playing && !clock.is_looping && self.shown_time_s() >= clock.range_s[1] {
            self.show_time(clock.range_s[0]); // From the end there is no way on.
        }
        if self.playback.playing && !self.preset_file.preset.is_moving() {
            self.tell(Level::Info, "Nothing moves in this preset yet: key a value at two times, or give the scene a spin");
        }
    }

    /// Shows the frame before or after, on the grid that begins with the range.
    pub(super) fn step_time(&mut self, frames: f64) {
        self.playback.playing = false;
        let [from_s, _] = self.preset_file.preset.clock.range_s;
        let place = (self.shown_time_s() - from_s) / STEP_S;
        // From between two frames, a step leads to the next one on that side.
        let next = if frames < 0.0 { (place - 1e-6).floor() + frames + 1.0 } else { (place + 1e-6).ceil() + frames - 1.0 };
        let next = if (place - place.round()).abs() < 1e-6 { place.round() + frames } else { next };
        self.show_time(from_s + next * STEP_S);
    }

    pub(super) fn rewind(&mut self) {
        self.show_time(self.preset_file.preset.clock.range_s[0]);
    }

    /// The session at the moment that is shown.
    pub(super) fn shown_preset(&self) -> Preset {
        let mut preset = self.preset_file.preset.clone();
        preset.clock.time_s = self.shown_time_s();
        preset
    }

    /// The stack at the moment that is shown, without muted effects.
    pub(super) fn visible_stack(&self) -> Stack {
        let mut stack = self.preset_file.preset.stack_at(self.shown_time_s());
        stack.0.retain(|enabled| !self.muted.contains(enabled.effect.name));
        stack
    }

    /// An enabled effect's values at the moment that is shown.
    pub(super) fn shown_words(&self, effect: &Effect) -> Option<Vec<u32>> {
        let preset = &self.preset_file.preset;
        let enabled = preset.stack.get(effect.name)?;
        Some(preset.animation.evaluate_words(effect.name, &enabled.words, self.shown_time_s()))
    }

    /// A parameter's value at the moment that is shown.
    pub(super) fn shown_value(&self, effect: &Effect, field: &Field) -> Option<Vec<f64>> {
        self.shown_words(effect).map(|words| field.get(&words))
    }
}
