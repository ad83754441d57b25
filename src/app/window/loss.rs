//! Whether the graphics device of the window was lost.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

/// Set when the window closes because its device was lost.
#[derive(Clone, Debug, Default)]
pub struct LossFlag(Arc<AtomicBool>);

impl LossFlag {
    pub fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
