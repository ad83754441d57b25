//! What a trade measures, and how far it is.

use std::sync::{
    Mutex,
    atomic::{AtomicBool, Ordering},
};

use crate::{accuracy::Axis, preset::Preset};

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

/// How far a trade is; shared with the thread that measures.
#[derive(Default)]
pub struct Progress {
    is_canceled: AtomicBool,
    state: Mutex<(usize, usize, String)>,
}

impl Progress {
    /// Says that `done` of `all` steps are done and what comes next. Returns false if the trade was canceled.
    pub fn report(&self, done: usize, all: usize, what: &str) -> bool {
        *self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = (done, all, what.to_owned());
        !self.is_canceled()
    }

    pub fn cancel(&self) {
        self.is_canceled.store(true, Ordering::Relaxed);
    }

    pub fn is_canceled(&self) -> bool {
        self.is_canceled.load(Ordering::Relaxed)
    }

    /// Steps done, all steps, and what is being done.
    pub fn read(&self) -> (usize, usize, String) {
        self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
    }
}
