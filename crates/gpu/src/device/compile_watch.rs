//! The watch over compiling: it is told when a renderer begins to compile, and it can stop the
//! renderer before the next pipeline.

use std::sync::atomic::{AtomicBool, Ordering};

use super::error::RenderError;

/// See the module's first line. Threads share it.
pub struct CompileWatch {
    began: Box<dyn Fn() + Send + Sync>,
    is_stopped: AtomicBool,
}

impl CompileWatch {
    /// `began` is called on the thread that draws, each time before it compiles something.
    pub fn new(began: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            began: Box::new(began),
            is_stopped: AtomicBool::new(false),
        }
    }

    /// Lets pipelines that are being compiled end, and begins no other until [`Self::allow`].
    pub fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
    }

    pub fn allow(&self) {
        self.is_stopped.store(false, Ordering::Relaxed);
    }

    pub fn is_stopped(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }

    pub(crate) fn begin(&self) {
        (self.began)();
    }

    /// Errors: [`RenderError::Stopped`] after [`Self::stop`].
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        if self.is_stopped() {
            Err(RenderError::Stopped)
        } else {
            Ok(())
        }
    }
}
