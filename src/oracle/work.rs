//! Work that can be canceled: it ends at the next row, triangle or stage.
//!
//! Canceled work unwinds, so that a picture which is half finished never looks like one that is finished. [`Work::run`] catches that.
//! Loops that take long ask for a [`Checkpoint`] on the thread that begins them and pass it in every turn, on whatever thread.

use std::{
    any::Any,
    cell::RefCell,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
};

thread_local! {
    /// The work that this thread does.
    static CURRENT: RefCell<Option<Arc<Work>>> = const { RefCell::new(None) };
}

/// The payload with which canceled work unwinds.
struct Canceled;

/// A piece of work that another thread can watch and cancel.
#[derive(Debug, Default)]
pub struct Work {
    is_canceled: AtomicBool,
    stage: Mutex<&'static str>,
    stages_begun: AtomicU32,
}

impl Work {
    /// Ends the work at its next checkpoint.
    pub fn cancel(&self) {
        self.is_canceled.store(true, Ordering::Relaxed);
    }

    pub fn is_canceled(&self) -> bool {
        self.is_canceled.load(Ordering::Relaxed)
    }

    /// What is being done, and how many stages have begun.
    pub fn stage(&self) -> (&'static str, u32) {
        (*self.stage.lock().unwrap_or_else(PoisonError::into_inner), self.stages_begun.load(Ordering::Relaxed))
    }

    /// Says what is done next.
    pub fn begin(&self, stage: &'static str) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage;
        self.stages_begun.fetch_add(1, Ordering::Relaxed);
    }

    /// Does `work` on this thread; none if it was canceled before it was finished, even if only its last checkpoint has passed.
    pub fn run<T>(self: &Arc<Self>, work: impl FnOnce() -> T) -> Option<T> {
        self.run_to_its_end(work).filter(|_| !self.is_canceled())
    }

    /// Does `work` on this thread, and returns what it returns even if it was canceled, unless it unwound.
    pub fn run_to_its_end<T>(self: &Arc<Self>, work: impl FnOnce() -> T) -> Option<T> {
        let before = CURRENT.replace(Some(self.clone()));
        let outcome = catch_unwind(AssertUnwindSafe(work));
        CURRENT.set(before);
        match outcome {
            Ok(result) => Some(result),
            Err(payload) if is_cancellation(&*payload) => None,
            Err(payload) => resume_unwind(payload),
        }
    }
}

/// Returns true if work unwound because it was canceled, and not because of a bug.
pub fn is_cancellation(payload: &(dyn Any + Send)) -> bool {
    payload.is::<Canceled>()
}

/// Where canceled work ends.
pub struct Checkpoint(Option<Arc<Work>>);

impl Checkpoint {
    /// Goes on, or ends the work if it was canceled.
    pub fn pass(&self) {
        if self.0.as_ref().is_some_and(|work| work.is_canceled()) {
            resume_unwind(Box::new(Canceled));
        }
    }
}

/// The checkpoint of the work that this thread does.
pub(super) fn checkpoint() -> Checkpoint {
    Checkpoint(CURRENT.with_borrow(Clone::clone))
}

/// Begins a stage of the work that this thread does, and ends it if it was canceled.
pub(super) fn stage(name: &'static str) {
    let checkpoint = checkpoint();
    if let Some(work) = &checkpoint.0 {
        work.begin(name);
    }
    checkpoint.pass();
}

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::*;

    #[test]
    fn canceled_work_ends_on_every_thread_and_gives_nothing() {
        let work = Arc::new(Work::default());
        let visited = AtomicU32::new(0);
        let result = work.run(|| {
            let checkpoint = checkpoint();
            (0..1_000_000).into_par_iter().for_each(|_| {
                checkpoint.pass();
                if visited.fetch_add(1, Ordering::Relaxed) == 10 {
                    work.cancel();
                }
            });
            "finished"
        });
        assert_eq!(result, None);
        assert!(visited.load(Ordering::Relaxed) < 1_000_000);
        assert!(CURRENT.with_borrow(Option::is_none), "the thread is free for other work");
    }

    #[test]
    fn work_that_is_not_canceled_gives_its_result_and_a_bug_stays_a_panic() {
        let work = Arc::new(Work::default());
        let result = work.run(|| {
            stage("one");
            stage("two");
            checkpoint().pass();
            7
        });
        assert_eq!((result, work.stage()), (Some(7), ("two", 2)));
        let bug = catch_unwind(AssertUnwindSafe(|| work.run(|| panic!("a bug"))));
        assert!(!is_cancellation(&*bug.expect_err("it is not hidden")));
    }
}
