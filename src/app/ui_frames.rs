//! UI frames: how long the UI thread takes for the frames of the window. A long one is a stall: what the user does is not seen meanwhile.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

/// Frames that are remembered.
const HISTORY: usize = 600;

/// The newest frames of the window.
#[derive(Clone, Debug, Default)]
pub struct UiFrames {
    /// Milliseconds, oldest first.
    times_ms: VecDeque<f64>,
    /// Begin and end of the newest frame, and whether the next one was due at once.
    newest: Option<(Instant, Instant, bool)>,
}

impl UiFrames {
    /// A frame begins. `painted` is how long the frame before took with painting, where that is known.
    pub fn begin(&mut self, now: Instant, painted: Option<Duration>) {
        if let Some((begun, ended, is_due)) = self.newest.take() {
            // Between a frame and one that is due at once lies only work: painting, presenting, and what the driver makes wait.
            let taken = if is_due { now - begun } else { (ended - begun).max(painted.unwrap_or_default()) };
            self.times_ms.push_back(taken.as_secs_f64() * 1e3);
            self.times_ms.drain(..self.times_ms.len().saturating_sub(HISTORY));
        }
        self.newest = Some((now, now, false));
    }

    /// The frame ends; `is_due` if it asked for another one at once.
    pub fn end(&mut self, now: Instant, is_due: bool) {
        if let Some((_, ended, due)) = &mut self.newest {
            (*ended, *due) = (now, is_due);
        }
    }

    /// The longest of the newest frames, milliseconds, and how many frames those are; none before the second frame.
    pub fn longest(&self) -> Option<(f64, usize)> {
        let longest = self.times_ms.iter().copied().reduce(f64::max)?;
        Some((longest, self.times_ms.len()))
    }

    /// The newest times, milliseconds.
    pub fn times_ms(&self) -> Vec<f64> {
        self.times_ms.iter().copied().collect()
    }

    /// Forgets the times of before.
    pub fn clear(&mut self) {
        self.times_ms.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_takes_its_own_time_or_until_one_that_was_due() {
        let (start, ms) = (Instant::now(), Duration::from_millis);
        let mut frames = UiFrames::default();
        frames.begin(start, None);
        frames.end(start + ms(4), false);
        assert_eq!(frames.longest(), None);
        frames.begin(start + ms(1000), None);
        assert_eq!(frames.longest(), Some((4.0, 1)), "a window at rest does not stall");
        frames.end(start + ms(1003), true);
        frames.begin(start + ms(1250), Some(ms(20)));
        assert_eq!(frames.longest(), Some((250.0, 2)), "the next frame was due, and something kept it waiting");
        frames.end(start + ms(1255), false);
        frames.begin(start + ms(3000), Some(ms(300)));
        assert_eq!(frames.longest(), Some((300.0, 3)), "painting counts");
        frames.clear();
        assert_eq!(frames.longest(), None);
    }

    #[test]
    fn old_frames_are_forgotten() {
        let start = Instant::now();
        let mut frames = UiFrames::default();
        for i in 0..=2 * HISTORY as u64 {
            let begun = start + Duration::from_secs(i);
            frames.begin(begun, None);
            frames.end(begun + Duration::from_millis(if i == 0 { 900 } else { 5 }), false);
        }
        assert_eq!(frames.longest(), Some((5.0, HISTORY)));
    }
}
