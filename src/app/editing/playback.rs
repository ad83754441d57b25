//! Playback: the time that is shown while the preset plays. It is not part of the preset, so undo
//! does not change it.

use crate::preset::{Clock, animation::MAX_TIME_S};

/// A step in time, seconds.
pub const STEP_S: f64 = 1.0 / 30.0;

/// A frame that took longer counts as this long, seconds, so that a slow frame does not skip ahead.
const MAX_FRAME_S: f64 = 0.25;

#[derive(Default)]
pub struct Playback {
    pub playing: bool,
    /// The pointer holds the time: playing does not advance it.
    pub is_held: bool,
    /// The time of the picture that is asked for next, seconds, where it is not the preset's own.
    at_s: Option<f64>,
    /// The time of the picture that is seen, which may come later than it was asked for.
    seen_s: Option<f64>,
}

impl Playback {
    /// The time that panels show, and that edits are made at: while the preset plays, that of the
    /// picture that is seen.
    pub fn shown_time_s(&self, clock: &Clock) -> f64 {
        let seen_s = self.seen_s.filter(|_| self.playing && !self.is_held);
        seen_s.unwrap_or(self.next_time_s(clock))
    }

    /// The time of the picture that is asked for next.
    pub fn next_time_s(&self, clock: &Clock) -> f64 {
        self.at_s.unwrap_or(clock.time_s)
    }

    /// The picture that is seen has this time.
    pub fn see(&mut self, time_s: Option<f64>) {
        self.seen_s = time_s;
    }

    /// Stops at the picture that is seen.
    pub fn pause(&mut self) {
        if let Some(seen_s) = self.seen_s.filter(|_| self.playing) {
            self.show(seen_s);
        }
        self.playing = false;
    }

    /// Shows another time; one that is not finite is ignored.
    pub fn show(&mut self, time_s: f64) {
        if time_s.is_finite() {
            self.at_s = Some(time_s.clamp(-MAX_TIME_S, MAX_TIME_S));
        }
    }

    /// Shows the preset's own time.
    pub fn show_own(&mut self) {
        self.at_s = None;
    }

    /// Advances the time by a frame that took `passed_s` seconds, unless the pointer holds it.
    pub fn advance(&mut self, clock: &Clock, passed_s: f64) {
        if self.playing && !self.is_held {
            let (time_s, goes_on) = clock.after(self.next_time_s(clock), passed_s.min(MAX_FRAME_S));
            self.show(time_s);
            self.playing = goes_on;
        }
    }

    /// Plays or pauses. At the end of a range that does not loop, it plays from the start.
    pub fn toggle(&mut self, clock: &Clock) {
        if self.playing {
            return self.pause();
        }
        (self.playing, self.seen_s) = (true, None);
        if !clock.is_looping && self.shown_time_s(clock) >= clock.range_s[1] {
            self.show(clock.range_s[0]);
        }
    }

    /// Pauses and shows a frame before or after, on the grid that begins with the range.
    pub fn step(&mut self, clock: &Clock, frames: f64) {
        self.pause();
        let [from_s, _] = clock.range_s;
        let position = (self.shown_time_s(clock) - from_s) / STEP_S;
        // From between two frames, a step leads to the next one on that side.
        let next = if frames < 0.0 {
            (position - 1e-6).floor() + frames + 1.0
        } else {
            (position + 1e-6).ceil() + frames - 1.0
        };
        let next = if (position - position.round()).abs() < 1e-6 {
            position.round() + frames
        } else {
            next
        };
        self.show(from_s + next * STEP_S);
    }
}
