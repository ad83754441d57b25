//! UI frames: how long the UI thread takes for the frames of the window. A long one is a stall:
//! what the user does is not seen meanwhile.

use std::{collections::VecDeque, time::Duration};

use eframe::egui::{self, Plugin, RawInput, ViewportId};
use web_time::Instant;

/// Frames that are remembered.
const HISTORY: usize = 600;
/// A button that is held longer, in frames that take no time, is not clicked, seconds.
const CLICK_S: f64 = 0.8;

/// How long the UI thread took for a frame of the window, milliseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameTime {
    /// Input, panels and layout.
    pub panels: f64,
    /// Handing it to the device, as far as the window system knows.
    pub painting: f64,
    /// What the next frame waited for beside that although it was due: presenting, and what the
    /// driver makes wait.
    pub waiting: f64,
}

impl FrameTime {
    pub fn total(&self) -> f64 {
        self.panels + self.painting + self.waiting
    }
}

/// What happened since the last note.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noted {
    /// Frames of the window.
    pub frames: usize,
    pub longest: FrameTime,
    /// From the frame that took an input to the end of painting the one that shows its picture,
    /// milliseconds: pictures that compiled nothing, and those that did.
    pub latencies_ms: [Vec<f64>; 2],
}

/// The newest frames of the window. A plugin, because egui alone knows when a frame asks for the
/// next one.
#[derive(Debug, Default)]
pub struct UiFrames {
    /// Oldest first.
    times: VecDeque<FrameTime>,
    newest: Option<Frame>,
    /// The frame before the newest, until it is known how long it was painted.
    painting: Option<Frame>,
    noted: Noted,
}

#[derive(Clone, Debug)]
struct Frame {
    begun: Instant,
    ended: Instant,
    /// After this long the next frame is due.
    next_in: Duration,
    /// Pictures that it shows first: when they were asked for, and whether something was compiled
    /// for them.
    shows: Vec<(Instant, bool)>,
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
        self.close();
        if let Some(frame) = self.newest.take() {
            // What a frame that is due waits for is work: painting, presenting, and what the driver
            // makes wait.
            let late = (now - frame.ended).saturating_sub(frame.next_in);
            self.times.push_back(FrameTime {
                panels: ms(frame.ended - frame.begun),
                painting: 0.0,
                waiting: ms(late),
            });
            self.times.drain(..self.times.len().saturating_sub(HISTORY));
            self.painting = Some(frame);
        }
        self.newest = Some(Frame {
            begun: now,
            ended: now,
            next_in: Duration::MAX,
            shows: Vec::new(),
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
            newest.painting = (ms(taken) - newest.panels).max(0.0);
            newest.waiting = (newest.waiting - newest.painting).max(0.0);
        }
        self.close();
    }

    /// Counts the frame before the newest; nothing more will be known of it.
    fn close(&mut self) {
        if let (Some(frame), Some(time)) = (self.painting.take(), self.times.back()) {
            self.noted.frames += 1;
            if time.total() > self.noted.longest.total() {
                self.noted.longest = *time;
            }
            for (asked_at, is_compiled) in frame.shows {
                let waited = frame.begun.saturating_duration_since(asked_at);
                self.noted.latencies_ms[usize::from(is_compiled)]
                    .push(ms(waited) + time.panels + time.painting);
            }
        }
    }

    /// When the frame that is being made began; none before the first.
    pub fn begun(&self) -> Option<Instant> {
        self.newest.as_ref().map(|frame| frame.begun)
    }

    /// The frame that is being made is the first to show a picture that was asked for at
    /// `asked_at`.
    pub fn shows(&mut self, asked_at: Instant, is_compiled: bool) {
        if let Some(newest) = &mut self.newest {
            newest.shows.push((asked_at, is_compiled));
        }
    }

    /// What happened since the last call.
    pub fn take_noted(&mut self) -> Noted {
        std::mem::take(&mut self.noted)
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
    fn a_note_tells_the_longest_frame_and_how_long_pictures_took_until_they_were_painted() {
        let (start, ms) = (Instant::now(), Duration::from_millis);
        let mut frames = UiFrames::default();
        frames.begin(start);
        let asked_at = frames.begun().expect("a frame");
        frames.end(start + ms(5), Duration::ZERO);
        frames.begin(start + ms(45));
        frames.painted(ms(15));
        frames.shows(asked_at, false);
        frames.end(start + ms(49), Duration::MAX);
        frames.begin(start + ms(2000));
        frames.painted(ms(24));
        let Noted {
            frames: count,
            longest,
            latencies_ms,
        } = frames.take_noted();
        assert_eq!((count, latencies_ms), (2, [vec![45.0 + 24.0], vec![]]));
        assert_eq!(
            longest,
            FrameTime {
                panels: 5.0,
                painting: 10.0,
                waiting: 30.0
            }
        );
        assert_eq!(
            frames.take_noted(),
            Noted::default(),
            "a frame is told once"
        );
        frames.shows(start + ms(1000), true);
        frames.end(start + ms(2003), Duration::MAX);
        // Where the window system does not say how long painting took, the frame counts without it.
        frames.begin(start + ms(3000));
        frames.end(start + ms(3001), Duration::MAX);
        frames.begin(start + ms(4000));
        assert_eq!(frames.take_noted().latencies_ms, [vec![], vec![1003.0]]);
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
