//! What is measured, and how far the measurement is.

use std::sync::{
    Arc, Mutex, MutexGuard, PoisonError,
    atomic::{AtomicU64, Ordering},
};

use super::pace::Pace;
use crate::{accuracy::Axis, preset::Preset, work::Work};

/// Frames that every combination is drawn for.
pub const SAMPLES: usize = 30;

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
}

/// How far a measurement is; shared with the thread that measures.
pub struct Progress {
    /// What the oracle does for it.
    pub work: Arc<Work>,
    state: Mutex<State>,
    /// When the measurement may go on, milliseconds on the clock of `began`.
    paused_until_ms: AtomicU64,
    began: web_time::Instant,
}

struct State {
    pace: Pace,
    /// What is being done.
    now: String,
}

/// The measurement waits this long after the last thing that the person did, seconds.
const PAUSE_S: f64 = 1.0;

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
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Records what has been done and what comes next.
    pub fn report(&self, now: &str, record: impl FnOnce(&mut Pace)) {
        let mut state = self.state();
        record(&mut state.pace);
        now.clone_into(&mut state.now);
    }

    pub fn cancel(&self) {
        self.work.cancel();
    }

    pub fn is_canceled(&self) -> bool {
        self.work.is_canceled()
    }

    /// The person works in the window: the measurement waits until they have rested.
    pub fn pause(&self) {
        let until_s = self.began.elapsed().as_secs_f64() + PAUSE_S;
        self.paused_until_ms
            .store((1e3 * until_s) as u64, Ordering::Relaxed);
    }

    /// Returns true while the measurement waits for the person to rest.
    pub fn is_paused(&self) -> bool {
        self.began.elapsed().as_millis() < u128::from(self.paused_until_ms.load(Ordering::Relaxed))
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
