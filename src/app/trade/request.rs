//! What is measured, and how far the measurement is.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};

use serde::{Deserialize, Serialize};

use super::pace::{Kind, Pace};
#[cfg(target_arch = "wasm32")]
use crate::preset_file::PresetFile;
use crate::{accuracy::Axis, preset::Preset, work::Work};

/// Samples of every combination.
pub const SAMPLES: usize = 30;

/// Most pixels that are measured, where there is a limit: in a page one thread judges them.
pub const MOST_PIXELS: Option<u32> = match cfg!(target_arch = "wasm32") {
    true => Some(640 * 480),
    false => None,
};

/// The size at which a picture of `size` is measured: with at most so many pixels, and of about the
/// same shape.
pub fn measured_size(size: [u32; 2], most_pixels: Option<u32>) -> [u32; 2] {
    let pixels = f64::from(size[0]) * f64::from(size[1]);
    match most_pixels.map(f64::from) {
        Some(most) if pixels > most => {
            let reduced = |side: u32| f64::from(side) * (most / pixels).sqrt();
            // A picture that is thin has a side of one pixel.
            let width = reduced(size[0]).clamp(1.0, most).floor();
            let height = reduced(size[1]).clamp(1.0, most / width).floor();
            [width as u32, height as u32]
        }
        _ => size,
    }
}

/// What is measured: the preset as it was, its size in pixels, and the axes.
#[derive(Clone)]
pub struct Request {
    pub preset: Preset,
    pub size: [u32; 2],
    pub axes: Vec<&'static Axis>,
    /// Name of the preset.
    pub title: String,
}

impl Request {
    /// Number of combinations of the options of its axes.
    pub fn combinations(&self) -> usize {
        self.axes.iter().map(|axis| axis.words.len()).product()
    }

    /// The preset as a file that says where its scene is read; `open` is the file that it comes
    /// from.
    #[cfg(target_arch = "wasm32")]
    pub fn preset_file(&self, open: &PresetFile) -> PresetFile {
        let mut preset_file = open.clone();
        preset_file.preset = self.preset.clone();
        preset_file.preset.scene = preset_file.scene_source();
        preset_file
    }
}

/// What a measurement does now, and what that has ended.
#[derive(Serialize, Deserialize)]
pub struct Report {
    pub now: String,
    /// A step of this kind took so many seconds.
    pub done: Option<(Kind, f64)>,
    /// There are so many steps of this kind.
    pub expected: Option<(Kind, usize)>,
}

/// How far a measurement is; shared with the thread that measures.
pub struct Progress {
    /// What the oracle does for it.
    pub work: Arc<Work>,
    state: Mutex<State>,
    /// When the measurement may go on, milliseconds on the clock of `began`.
    paused_until_ms: AtomicU64,
    began: web_time::Instant,
    /// Is told each report.
    tell: Option<fn(&Report)>,
}

struct State {
    pace: Pace,
    /// What is being done.
    now: String,
}

/// The measurement waits this long after the last thing that the person did.
const PAUSE: Duration = Duration::from_secs(1);

impl Progress {
    /// Nothing is done yet of a measurement that is expected to take as long as `pace` says.
    pub fn new(pace: Pace) -> Self {
        Self {
            work: Arc::default(),
            state: Mutex::new(State {
                pace,
                now: "the reference picture".into(),
            }),
            paused_until_ms: AtomicU64::new(0),
            began: web_time::Instant::now(),
            tell: None,
        }
    }

    /// That of a measurement in a worker, which calls `tell` with each report.
    #[cfg(target_arch = "wasm32")]
    pub fn telling(tell: fn(&Report)) -> Self {
        Self {
            tell: Some(tell),
            ..Self::new(Pace::default())
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Records what has been done and what comes next.
    pub fn report(&self, report: Report) {
        self.tell.iter().for_each(|tell| tell(&report));
        let mut state = self.state();
        if let Some((kind, passed_s)) = report.done {
            state.pace.add(kind, passed_s);
        }
        if let Some((kind, all)) = report.expected {
            state.pace.expect(kind, all);
        }
        state.now = report.now;
    }

    /// Have the reference pictures been drawn?
    #[cfg(target_arch = "wasm32")]
    pub fn has_reference(&self) -> bool {
        self.state().pace.has_done(Kind::Reference)
    }

    pub fn cancel(&self) {
        self.work.cancel();
    }

    pub fn is_canceled(&self) -> bool {
        self.work.is_canceled()
    }

    /// The person works in the window: the measurement waits until they have rested.
    pub fn pause(&self) {
        self.pause_for(PAUSE);
    }

    /// The measurement waits for so long, from now on.
    pub fn pause_for(&self, wait: Duration) {
        let until = self.began.elapsed().saturating_add(wait);
        let until_ms = u64::try_from(until.as_millis()).unwrap_or(u64::MAX);
        self.paused_until_ms.store(until_ms, Ordering::Relaxed);
    }

    /// How long the measurement still waits for the person to rest.
    pub fn pause_left(&self) -> Duration {
        let until = Duration::from_millis(self.paused_until_ms.load(Ordering::Relaxed));
        until.saturating_sub(self.began.elapsed())
    }

    /// Returns true while the measurement waits for the person to rest.
    pub fn is_paused(&self) -> bool {
        !self.pause_left().is_zero()
    }

    /// The fraction that is done, the seconds that are left, and what is being done.
    pub fn read(&self) -> (f64, f64, String) {
        let state = self.state();
        (
            state.pace.fraction(),
            state.pace.left_s(),
            state.now.clone(),
        )
    }

    /// What has been learned about the speed of this machine.
    pub fn pace(&self) -> Pace {
        self.state().pace.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::measured_size;

    #[test]
    fn a_measured_picture_has_at_most_so_many_pixels_and_its_shape() {
        let most = 320 * 240;
        for size in [
            [1600, 1200],
            [320, 241],
            [3000, 20],
            [1, 4_000_000],
            [9, 9],
            [0, 5],
        ] {
            assert_eq!(measured_size(size, None), size);
            let [width, height] = measured_size(size, Some(most));
            assert!(width * height <= most, "{size:?} is {width} x {height}");
            let is_small = u64::from(size[0]) * u64::from(size[1]) <= u64::from(most);
            assert_eq!([width, height] == size, is_small, "{size:?}");
        }
        assert_eq!(measured_size([1600, 1200], Some(most)), [320, 240]);
    }
}
