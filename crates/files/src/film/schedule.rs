//! The times of a film's frames.

use std::ops::Range;

use super::error::FilmError;
use crate::preset::{Clock, animation::MAX_TIME_S};

/// Largest number of frames: almost an hour at 30 per second.
const MAX_FRAMES: u32 = 100_000;

/// Largest number of frames per second; APNG counts milliseconds.
const MAX_FPS: f64 = 1000.0;

/// What a person asks for; without a time, that of the preset's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// Time of frame 0, seconds.
    pub from_s: Option<f64>,
    /// The end, which is not drawn, seconds.
    pub to_s: Option<f64>,
    /// Frames per second, 0.001 to 1000.
    pub fps: f64,
    /// First frame to draw, and the one after the last.
    pub frames: [Option<u32>; 2],
}

/// The times of the frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Begin and end, seconds.
    pub range_s: [f64; 2],
    /// Frames per second.
    pub fps: f64,
    /// Seconds of the clock from frame to frame.
    step_s: f64,
    /// Number of frames of the whole film.
    pub total: u32,
    /// The frames to draw.
    pub frames: Range<u32>,
}

impl Schedule {
    /// The frames of a preset with this `clock`. `dashes` stands in front of the names of times in
    /// errors.
    pub fn new(times: &Times, clock: &Clock, dashes: &str) -> Result<Self, FilmError> {
        let [begin_s, end_s] = clock.range_s;
        let (from_s, to_s, fps) = (
            times.from_s.unwrap_or(begin_s),
            times.to_s.unwrap_or(end_s),
            times.fps,
        );
        for (name, time_s) in [("from", from_s), ("to", to_s)] {
            if !(-MAX_TIME_S..=MAX_TIME_S).contains(&time_s) {
                return Err(FilmError::Times(format!(
                    "{dashes}{name} {time_s} lies outside -1e9..=1e9"
                )));
            }
        }
        if to_s <= from_s {
            return Err(FilmError::Times(format!(
                "{dashes}to {to_s} must come after {dashes}from {from_s}"
            )));
        }
        if !(0.001..=MAX_FPS).contains(&fps) {
            return Err(FilmError::Times(format!(
                "{dashes}fps {fps} lies outside 0.001..=1000"
            )));
        }
        let step_s = clock.speed / fps;
        // Without the margin, rounding could add a last frame at the end, which equals the first of
        // the next round.
        let count = ((to_s - from_s) / step_s - 1e-6).ceil().max(1.0);
        if count > f64::from(MAX_FRAMES) {
            return Err(FilmError::Times(format!(
                "{count} frames from {from_s} to {to_s} s are too many; at most {MAX_FRAMES} are allowed"
            )));
        }
        let total = count as u32;
        let [first, end] = times.frames;
        let frames = first.unwrap_or(0)..end.unwrap_or(total);
        if frames.is_empty() || frames.end > total {
            let Range { start, end } = frames;
            return Err(FilmError::Times(format!(
                "{dashes}frames {start}..{end} lies outside 0..{total}, the frames from {from_s} to {to_s} s at {fps} a second"
            )));
        }
        Ok(Self {
            range_s: [from_s, to_s],
            fps,
            step_s,
            total,
            frames,
        })
    }

    /// The clock's time of a frame, seconds. Computed from the frame number, so that errors do not
    /// add up and every machine gets the same time.
    pub fn time_s(&self, frame: u32) -> f64 {
        self.range_s[0] + f64::from(frame) * self.step_s
    }

    /// How long each frame stays: the closest fraction of seconds that APNG can hold, numerator and
    /// denominator.
    pub fn frame_duration_s(&self) -> [u16; 2] {
        closest_fraction(self.fps, u16::MAX.into()).map(|part| part as u16)
    }

    /// The same for a video, which holds 120000/1001 frames a second, too.
    pub fn video_frame_duration_s(&self) -> [u32; 2] {
        closest_fraction(self.fps, u32::MAX)
    }
}

/// Frames a second from `30`, `29.97` or `30000/1001`; none for anything else.
pub fn read_rate(text: &str) -> Option<f64> {
    let (count, seconds) = text.split_once('/').unwrap_or((text, "1"));
    let [count, seconds] = [count, seconds].map(|part| part.trim().parse::<f64>().ok());
    Some(count? / seconds?)
}

/// The closest fraction to the inverse of `fps`, with a denominator of at most `most`.
fn closest_fraction(fps: f64, most: u32) -> [u32; 2] {
    let mut best = ([1, 1], f64::INFINITY);
    for numerator in 1..=1001u32 {
        let denominator = (f64::from(numerator) * fps).round();
        if !(1.0..=f64::from(most)).contains(&denominator) {
            continue;
        }
        let error = (f64::from(numerator) / denominator * fps - 1.0).abs();
        if error < best.1 - 1e-12 {
            best = ([numerator, denominator as u32], error);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(from_s: Option<f64>, to_s: Option<f64>, fps: f64, frames: [Option<u32>; 2]) -> Times {
        Times {
            from_s,
            to_s,
            fps,
            frames,
        }
    }

    #[test]
    fn a_loop_does_not_draw_its_first_moment_twice() {
        let clock = Clock::default();
        for fps in [24.0, 25.0, 29.97, 30.0, 60.0, 144.0, 1.0, 0.3] {
            let schedule =
                Schedule::new(&times(Some(-1.0), Some(3.1), fps, [None; 2]), &clock, "").unwrap();
            let last = schedule.time_s(schedule.total - 1);
            assert!(last < 3.1 && last + 1.0 / fps > 3.1 - 1e-6, "{fps}: {last}");
        }
        assert_eq!(
            Schedule::new(&times(None, None, 30.0, [None; 2]), &clock, "")
                .unwrap()
                .total,
            120
        );
    }

    #[test]
    fn the_speed_of_the_clock_is_the_speed_of_the_film() {
        let clock = Clock {
            range_s: [0.0, 4.0],
            speed: 2.0,
            ..Clock::default()
        };
        let schedule =
            Schedule::new(&times(None, None, 30.0, [Some(30), None]), &clock, "").unwrap();
        assert_eq!(
            (schedule.total, schedule.frames.clone(), schedule.time_s(30)),
            (60, 30..60, 2.0)
        );
    }

    #[test]
    fn a_rate_is_kept_as_a_fraction() {
        let closest = |fps| closest_fraction(fps, 65_535);
        let fractions = [30.0, 29.97, 0.5, 1000.0, 30_000.0 / 1001.0].map(closest);
        let exact = [[1, 30], [100, 2997], [2, 1], [1, 1000], [1001, 30_000]];
        assert_eq!(fractions, exact);
        let [numerator, denominator] = closest(23.976).map(f64::from);
        assert!((numerator / denominator * 23.976 - 1.0).abs() < 1e-9);
        assert!(closest(0.001)[1] == 1);
        let fast = 120_000.0 / 1001.0;
        assert_eq!(closest_fraction(fast, u32::MAX), [1001, 120_000]);
    }
}
