//! UI frames: how long the UI thread takes for the frames of the window. A long one is a stall:
//! what the user does is not seen meanwhile.

use std::{collections::VecDeque, time::Duration};

use egui::{self, Plugin, RawInput, ViewportId};
use web_time::Instant;

/// Frames that are remembered.
const HISTORY: usize = 600;
/// A button that is held longer, in frames that take no time, is not clicked, seconds.
const CLICK_S: f64 = 0.8;

/// How long the UI thread took for a frame of the window, milliseconds.
#[derive(Clone, Copy, Debug)]
struct FrameTime {
    /// Input, panels and layout.
    panels: f64,
    /// Handing it to the device, as far as the window system knows, or what the next frame waited
    /// for although it was due, whichever is longer.
    rest: f64,
}

impl FrameTime {
    fn total(&self) -> f64 {
        self.panels + self.rest
    }
}

/// The newest frames of the window. A plugin, because egui alone knows when a frame asks for the
/// next one.
#[derive(Debug, Default)]
pub struct UiFrames {
    /// Oldest first.
    times: VecDeque<FrameTime>,
    newest: Option<Frame>,
}

#[derive(Clone, Debug)]
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

    fn input_hook(&mut self, ctx: &egui::Context, _: &mut RawInput) {
        self.begin(Instant::now());
        let longest_s = self.longest_click_s();
        ctx.options_mut(|options| options.input_options.max_click_duration = longest_s);
    }

    fn output_hook(&mut self, _: &egui::Context, output: &mut egui::FullOutput) {
        let next_in = output
            .viewport_output
            .get(&ViewportId::ROOT)
            .map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        self.end(Instant::now(), next_in);
    }
}

fn ms(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}

impl UiFrames {
    fn begin(&mut self, now: Instant) {
        if let Some(frame) = self.newest.take() {
            // What a frame that is due waits for is work: painting, presenting, and what the driver
            // makes wait.
            let late = (now - frame.ended).saturating_sub(frame.next_in);
            self.times.push_back(FrameTime {
                panels: ms(frame.ended - frame.begun),
                rest: ms(late),
            });
            self.times.drain(..self.times.len().saturating_sub(HISTORY));
        }
        self.newest = Some(Frame {
            begun: now,
            ended: now,
            next_in: Duration::MAX,
        });
    }

    /// How long a click may take. egui times a press and its release by the frames that they come
    /// with, so the time of a slow frame between them does not count.
    fn longest_click_s(&self) -> f64 {
        CLICK_S + self.times.back().map_or(0.0, |time| time.total() / 1e3)
    }

    fn end(&mut self, now: Instant, next_in: Duration) {
        if let Some(newest) = &mut self.newest {
            (newest.ended, newest.next_in) = (now, next_in);
        }
    }

    /// The frame before took this long with painting, as far as the window system knows.
    pub fn painted(&mut self, taken: Duration) {
        if let Some(newest) = self.times.back_mut() {
            newest.rest = newest.rest.max(ms(taken) - newest.panels);
        }
    }

    /// When the frame that is being made began; none before the first.
    pub fn begun(&self) -> Option<Instant> {
        self.newest.as_ref().map(|frame| frame.begun)
    }

    /// The longest of the newest frames, milliseconds; none before the second frame.
    pub fn longest_ms(&self) -> Option<f64> {
        self.times.iter().map(FrameTime::total).reduce(f64::max)
    }

    /// The newest times, milliseconds.
    pub fn times_ms(&self) -> Vec<f64> {
        self.times.iter().map(FrameTime::total).collect()
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
        assert_eq!(
            frames.longest_ms(),
            Some(4.0),
            "a window at rest does not stall"
        );
        frames.painted(ms(20));
        assert_eq!(frames.longest_ms(), Some(20.0), "painting counts");
        frames.end(start + ms(1003), Duration::ZERO);
        frames.begin(start + ms(1250));
        assert_eq!(
            frames.times_ms(),
            [20.0, 250.0],
            "the next frame was due, and something kept it waiting"
        );
        frames.end(start + ms(1252), ms(120));
        frames.begin(start + ms(1300));
        frames.end(start + ms(1301), ms(120));
        frames.begin(start + ms(1451));
        assert_eq!(
            frames.times_ms(),
            [20.0, 250.0, 2.0, 31.0],
            "one that comes early is not late"
        );
    }

    #[test]
    fn old_frames_are_forgotten() {
        let start = Instant::now();
        let mut frames = UiFrames::default();
        for i in 0..=2 * HISTORY as u64 {
            let begun = start + Duration::from_secs(i);
            frames.begin(begun);
            frames.end(
                begun + Duration::from_millis(if i == 0 { 900 } else { 5 }),
                Duration::MAX,
            );
        }
        assert_eq!(
            (frames.longest_ms(), frames.times_ms().len()),
            (Some(5.0), HISTORY)
        );
    }

    #[test]
    fn a_slow_frame_does_not_make_a_click_a_long_press() {
        let (mut frames, start) = (UiFrames::default(), Instant::now());
        let ms = Duration::from_millis;
        frames.begin(start);
        frames.end(start + ms(4), Duration::ZERO);
        frames.begin(start + ms(1000));
        assert!(frames.longest_click_s() > 1.7, "the frame took a second");
        frames.end(start + ms(1004), Duration::MAX);
        frames.begin(start + ms(9000));
        assert!(frames.longest_click_s() < 0.9, "nothing was due");
    }
}
