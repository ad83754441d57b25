//! UI frames: how long the UI thread takes for the frames of the window. A long one is a stall: what the user does is not seen meanwhile.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use eframe::egui::{self, Plugin, RawInput, ViewportId};

/// Frames that are remembered.
const HISTORY: usize = 600;

/// The newest frames of the window. A plugin, because egui alone knows when a frame asks for the next one.
#[derive(Debug, Default)]
pub struct UiFrames {
    /// Milliseconds, oldest first.
    times_ms: VecDeque<f64>,
    newest: Option<Frame>,
}

#[derive(Clone, Copy, Debug)]
struct Frame {
    begun: Instant,
    ended: Instant,
    /// After this long the next frame is due.
    next_in: Duration,
}

impl Plugin for UiFrames {
    fn debug_name(&self) -> &'static str {
        "UI frames"
    }

    fn input_hook(&mut self, _: &egui::Context, _: &mut RawInput) {
        self.begin(Instant::now());
    }

    fn output_hook(&mut self, _: &egui::Context, output: &mut egui::FullOutput) {
        let next_in = output.viewport_output.get(&ViewportId::ROOT).map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        self.end(Instant::now(), next_in);
    }
}

impl UiFrames {
    fn begin(&mut self, now: Instant) {
        if let Some(Frame { begun, ended, next_in }) = self.newest {
            // What a frame that is due waits for is work: painting, presenting, and what the driver makes wait.
            let late = (now - ended).saturating_sub(next_in);
            self.times_ms.push_back(((ended - begun) + late).as_secs_f64() * 1e3);
            self.times_ms.drain(..self.times_ms.len().saturating_sub(HISTORY));
        }
        self.newest = Some(Frame { begun: now, ended: now, next_in: Duration::MAX });
    }

    fn end(&mut self, now: Instant, next_in: Duration) {
        if let Some(newest) = &mut self.newest {
            (newest.ended, newest.next_in) = (now, next_in);
        }
    }

    /// The frame before took this long with painting, as far as the window system knows.
    pub fn painted(&mut self, taken: Duration) {
        if let Some(newest) = self.times_ms.back_mut() {
            *newest = newest.max(taken.as_secs_f64() * 1e3);
        }
    }

    /// The longest of the newest frames, milliseconds; none before the second frame.
    pub fn longest_ms(&self) -> Option<f64> {
        self.times_ms.iter().copied().reduce(f64::max)
    }

    /// The newest times, milliseconds.
    pub fn times_ms(&self) -> Vec<f64> {
        self.times_ms.iter().copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_takes_its_own_time_and_what_one_that_is_due_waits() {
        let (start, ms) = (Instant::now(), Duration::from_millis);
        let mut frames = UiFrames::default();
        frames.begin(start);
        frames.end(start + ms(4), Duration::MAX);
        assert_eq!(frames.longest_ms(), None);
        frames.begin(start + ms(1000));
        assert_eq!(frames.longest_ms(), Some(4.0), "a window at rest does not stall");
        frames.painted(ms(20));
        assert_eq!(frames.longest_ms(), Some(20.0), "painting counts");
        frames.end(start + ms(1003), Duration::ZERO);
        frames.begin(start + ms(1250));
        assert_eq!(frames.times_ms(), [20.0, 250.0], "the next frame was due, and something kept it waiting");
        frames.end(start + ms(1252), ms(120));
        frames.begin(start + ms(1300));
        frames.end(start + ms(1301), ms(120));
        frames.begin(start + ms(1451));
        assert_eq!(frames.times_ms(), [20.0, 250.0, 2.0, 31.0], "one that comes early is not late");
    }

    #[test]
    fn old_frames_are_forgotten() {
        let start = Instant::now();
        let mut frames = UiFrames::default();
        for i in 0..=2 * HISTORY as u64 {
            let begun = start + Duration::from_secs(i);
            frames.begin(begun);
            frames.end(begun + Duration::from_millis(if i == 0 { 900 } else { 5 }), Duration::MAX);
        }
        assert_eq!((frames.longest_ms(), frames.times_ms().len()), (Some(5.0), HISTORY));
    }
}
