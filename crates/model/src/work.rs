//! Work that can be canceled: it ends at the next row, triangle or stage.
//!
//! What takes long returns a `Result`, so that a picture which is half finished never looks like
//! one that is finished. Its loops ask for a [`Checkpoint`] on the thread that begins them and pass
//! it in every turn, on any thread.

use std::{
    cell::RefCell,
    fmt,
    ops::Range,
    sync::{
        Arc, Mutex, OnceLock, PoisonError,
        atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
    },
    time::Duration,
};

use web_time::Instant;

use rayon::prelude::*;

thread_local! {
    /// The work that this thread does.
    static CURRENT: RefCell<Option<Arc<Work>>> = const { RefCell::new(None) };
}

/// Work ended before it was finished, because somebody canceled it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it was canceled")]
pub struct Canceled;

/// Gives the thread back the work that it did before.
struct Resumed(Option<Arc<Work>>);

impl Drop for Resumed {
    fn drop(&mut self) {
        CURRENT.set(self.0.take());
    }
}

/// A piece of work that another thread can watch and cancel.
#[derive(Debug, Default)]
pub struct Work {
    is_canceled: AtomicBool,
    stage: Mutex<&'static str>,
    stages_begun: AtomicU32,
    /// Is told each stage that begins.
    tell: Option<fn(&'static str)>,
    /// Bytes that are to be done, as far as they are known.
    expected: AtomicU64,
    /// Bytes that are done.
    done: AtomicU64,
    /// When the first bytes were expected.
    begun: OnceLock<Instant>,
}

/// How far work on bytes has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    pub done: u64,
    /// All bytes, as far as they are known.
    pub expected: u64,
    /// Since the first bytes were expected.
    pub elapsed: Duration,
}

impl Progress {
    /// The time that the rest takes at the speed so far; none before a tenth of a second has
    /// passed.
    pub fn time_left(&self) -> Option<Duration> {
        let is_known = self.done > 0 && self.elapsed >= Duration::from_millis(100);
        is_known.then(|| {
            self.elapsed
                .mul_f64(self.expected.saturating_sub(self.done) as f64 / self.done as f64)
        })
    }
}

impl fmt::Display for Progress {
    /// `120 of 580 MB, 2 s left`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let megabytes = |bytes: u64| bytes.div_ceil(1_000_000);
        write!(
            f,
            "{} of {} MB",
            megabytes(self.done.min(self.expected)),
            megabytes(self.expected)
        )?;
        match self.time_left() {
            Some(left) => write!(f, ", {:.0} s left", left.as_secs_f64().ceil()),
            None => Ok(()),
        }
    }
}

impl Work {
    /// Work that calls `tell` with each stage that begins, on the thread that begins it.
    pub fn telling(tell: fn(&'static str)) -> Self {
        Self {
            tell: Some(tell),
            ..Self::default()
        }
    }

    /// Ends the work at its next checkpoint.
    pub fn cancel(&self) {
        self.is_canceled.store(true, Ordering::Relaxed);
    }

    pub fn is_canceled(&self) -> bool {
        self.is_canceled.load(Ordering::Relaxed)
    }

    /// What is being done, and how many stages have begun.
    pub fn stage(&self) -> (&'static str, u32) {
        (
            *self.stage.lock().unwrap_or_else(PoisonError::into_inner),
            self.stages_begun.load(Ordering::Relaxed),
        )
    }

    /// Says what is done next.
    pub fn begin(&self, stage: &'static str) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage;
        self.stages_begun.fetch_add(1, Ordering::Relaxed);
        self.tell.iter().for_each(|tell| tell(stage));
    }

    /// How far work on bytes has come; none before any are expected.
    pub fn progress(&self) -> Option<Progress> {
        let [done, expected] =
            [&self.done, &self.expected].map(|bytes| bytes.load(Ordering::Relaxed));
        Some(Progress {
            done,
            expected,
            elapsed: self.begun.get()?.elapsed(),
        })
    }

    /// Does `work` on this thread; none if it was canceled, even if only its last checkpoint has
    /// passed.
    pub fn run<T>(self: &Arc<Self>, work: impl FnOnce() -> T) -> Option<T> {
        Some(self.run_to_its_end(work)).filter(|_| !self.is_canceled())
    }

    /// Does `work` on this thread, and returns what it returns even if it was canceled.
    pub fn run_to_its_end<T>(self: &Arc<Self>, work: impl FnOnce() -> T) -> T {
        let _resumed = Resumed(CURRENT.replace(Some(self.clone())));
        work()
    }
}

/// Where canceled work ends.
pub struct Checkpoint(Option<Arc<Work>>);

impl Checkpoint {
    /// Goes on, unless the work was canceled.
    pub fn pass(&self) -> Result<(), Canceled> {
        if self.0.as_ref().is_some_and(|work| work.is_canceled()) {
            Err(Canceled)
        } else {
            Ok(())
        }
    }

    /// Says that so many more bytes are to be done.
    pub fn expect(&self, bytes: u64) {
        if let Some(work) = &self.0 {
            work.begun.get_or_init(Instant::now);
            work.expected.fetch_add(bytes, Ordering::Relaxed);
        }
    }

    /// Says that so many more bytes are done, and goes on, unless the work was canceled.
    pub fn advance(&self, bytes: u64) -> Result<(), Canceled> {
        if let Some(work) = &self.0 {
            work.done.fetch_add(bytes, Ordering::Relaxed);
        }
        self.pass()
    }
}

/// The checkpoint of the work that this thread does.
pub fn checkpoint() -> Checkpoint {
    Checkpoint(CURRENT.with_borrow(Clone::clone))
}

/// Begins a stage of the work that this thread does.
pub fn stage(name: &'static str) -> Result<(), Canceled> {
    let checkpoint = checkpoint();
    if let Some(work) = &checkpoint.0 {
        work.begin(name);
    }
    checkpoint.pass()
}

/// Elements that are handled between two checkpoints: some milliseconds of work.
const PART: u32 = 1 << 16;

/// What `of_part` gives for every part of `count` elements, in their order. Parts are handled on
/// all threads.
pub fn map_parts<T: Send>(
    count: u32,
    of_part: impl Fn(Range<u32>) -> T + Sync,
) -> Result<Vec<T>, Canceled> {
    let checkpoint = checkpoint();
    let part = |index: u32| {
        checkpoint.pass()?;
        Ok(of_part(
            index * PART..count.min((index + 1).saturating_mul(PART)),
        ))
    };
    match count.div_ceil(PART) {
        // Waking other threads costs more than a part.
        parts @ 0..=1 => (0..parts).map(part).collect(),
        parts => (0..parts).into_par_iter().map(part).collect(),
    }
}

/// Most items that [`map_each`] handles between two checkpoints.
const MOST_ITEMS: usize = 128;

/// What `each` gives for every item, in their order, on all threads.
pub fn map_each<I: Send, T: Send>(
    items: impl IndexedParallelIterator<Item = I>,
    each: impl Fn(I) -> T + Sync,
) -> Result<Vec<T>, Canceled> {
    let (checkpoint, count) = (checkpoint(), items.len());
    let run = |items: Vec<I>| {
        checkpoint.pass()?;
        Ok(items.into_iter().map(&each).collect::<Vec<T>>())
    };
    // Few items are shared among the threads, too.
    let together = (count / (8 * rayon::current_num_threads())).clamp(1, MOST_ITEMS);
    let runs = items
        .chunks(together)
        .map(run)
        .collect::<Result<Vec<_>, Canceled>>()?;
    let mut mapped = Vec::with_capacity(count);
    runs.into_iter().for_each(|run| mapped.extend(run));
    Ok(mapped)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canceled_work_ends_on_every_thread_and_gives_nothing() {
        let work = Arc::new(Work::default());
        let visited = AtomicU32::new(0);
        let result = work.run(|| {
            let checkpoint = checkpoint();
            (0..1_000_000).into_par_iter().try_for_each(|_| {
                checkpoint.pass()?;
                if visited.fetch_add(1, Ordering::Relaxed) == 10 {
                    work.cancel();
                }
                Ok::<_, Canceled>(())
            })?;
            Ok::<_, Canceled>("finished")
        });
        assert_eq!(result, None);
        assert!(visited.load(Ordering::Relaxed) < 1_000_000);
        assert!(
            CURRENT.with_borrow(Option::is_none),
            "the thread is free for other work"
        );
    }

    #[test]
    fn parts_are_all_elements_in_order() {
        for count in [0, 1, PART, PART + 1, 3 * PART + 7] {
            let parts = map_parts(count, |part| part).expect("nobody cancels it");
            assert!(
                parts
                    .iter()
                    .all(|part| part.len() <= PART as usize && !part.is_empty())
            );
            assert!(parts.into_iter().flatten().eq(0..count), "{count}");
        }
        let work = Arc::new(Work::default());
        work.cancel();
        assert_eq!(
            work.run_to_its_end(|| map_parts(3 * PART, |_| panic!("canceled work goes on"))),
            Err::<Vec<()>, _>(Canceled)
        );
    }

    #[test]
    fn each_item_is_mapped_in_order_until_the_work_is_canceled() {
        for count in [0, 1, MOST_ITEMS, 99 * MOST_ITEMS + 3] {
            let mapped =
                map_each((0..count).into_par_iter(), |item| 2 * item).expect("nobody cancels it");
            assert!(
                mapped.into_iter().eq((0..count).map(|item| 2 * item)),
                "{count}"
            );
        }
        let work = Arc::new(Work::default());
        work.cancel();
        assert_eq!(
            work.run_to_its_end(|| map_each((0..9).into_par_iter(), |_| panic!(
                "canceled work goes on"
            ))),
            Err::<Vec<()>, _>(Canceled)
        );
    }

    #[test]
    fn progress_counts_bytes_and_tells_the_time_left() {
        let work = Arc::new(Work::default());
        assert_eq!(work.progress(), None);
        work.run(|| {
            checkpoint().expect(580_000_000);
            (0..4)
                .into_par_iter()
                .map(|_| 30_000_000)
                .collect::<Vec<u64>>()
                .into_iter()
                .try_for_each(|bytes| checkpoint().advance(bytes))
        });
        let progress = Progress {
            elapsed: Duration::from_secs(2),
            ..work.progress().expect("bytes are expected")
        };
        assert_eq!(
            (progress.done, progress.expected),
            (120_000_000, 580_000_000)
        );
        assert_eq!(progress.to_string(), "120 of 580 MB, 8 s left");
        assert_eq!(
            Progress {
                elapsed: Duration::ZERO,
                ..progress
            }
            .to_string(),
            "120 of 580 MB",
            "no speed is known yet"
        );
        assert_eq!(checkpoint().advance(1), Ok(()));
        assert_eq!(
            work.progress().map(|progress| progress.done),
            Some(120_000_000),
            "other work is not counted"
        );
    }

    #[test]
    fn work_that_is_not_canceled_gives_its_result_and_a_bug_stays_a_panic() {
        let work = Arc::new(Work::default());
        let result = work.run(|| {
            stage("one")?;
            stage("two")?;
            checkpoint().pass().map(|()| 7)
        });
        assert_eq!((result, work.stage()), (Some(Ok(7)), ("two", 2)));
        let bug = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            work.run(|| panic!("a bug"))
        }));
        assert!(
            bug.is_err() && CURRENT.with_borrow(Option::is_none),
            "it is not hidden, and the thread is free"
        );
    }
}
