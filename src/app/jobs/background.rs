//! Background work: threads that yield the processor to the window, and pools of their own for the oracle's pictures.
//!
//! The window's thread uses the common pool for moments (a pick, the image of an overlay). A picture of the oracle there would keep it
//! waiting, for seconds with a large one.

use rayon::ThreadPoolBuilder;

/// Who goes first when the processor is short, most urgent first. The window itself comes before all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// The picture of the window, where the processor draws it.
    Picture,
    /// What nobody looks at yet: thumbnails, verdicts, films.
    Later,
}

impl Urgency {
    /// The nice value of Unix.
    const fn nice(self) -> i32 {
        match self {
            Self::Picture => 4,
            Self::Later => 12,
        }
    }
}

/// From now on this thread, and every thread that it starts, leaves the processor to more urgent ones. Drivers start threads, too: a
/// device that is opened afterwards is as urgent. On Linux alone; other systems with a CPU adapter are rare.
pub fn yield_processor(urgency: Urgency) {
    #[cfg(target_os = "linux")]
    {
        let nice = rustix::process::getpriority_process(None).unwrap_or_default();
        // Refused only by a sandbox; then everything is as urgent as before.
        let _ = rustix::process::setpriority_process(None, nice.max(urgency.nice()));
    }
    #[cfg(not(target_os = "linux"))]
    let _ = urgency.nice();
}

/// The result of `work`, from a thread that is as urgent as `urgency` says; so are the threads that it starts.
pub fn started_as<T: Send>(urgency: Urgency, work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let started = scope.spawn(|| {
            yield_processor(urgency);
            work()
        });
        started.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Runs `work` in a pool of its own and waits for it; never on the thread of the window.
///
/// In a pool that all work shares, a thread that waits for the parts of one picture takes up other work meanwhile; that work may wait for a
/// lock which the same thread holds.
pub fn compute<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    in_pool(Some(Urgency::Later), work)
}

/// As [`compute`], for what the user waits for: it does not yield to the window.
pub fn compute_urgently<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    in_pool(None, work)
}

fn in_pool<T: Send>(urgency: Option<Urgency>, work: impl FnOnce() -> T + Send) -> T {
    let builder = ThreadPoolBuilder::new().thread_name(|i| format!("background {i}"));
    match builder.start_handler(move |_| urgency.into_iter().for_each(yield_processor)).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

#[cfg(test)]
mod tests {
    use std::{
        sync::{Arc, Mutex, mpsc},
        thread::ThreadId,
        time::{Duration, Instant},
    };

    use rayon::prelude::*;

    use super::*;

    #[test]
    fn background_work_leaves_the_common_pool_to_the_window() {
        let (release, released) = (mpsc::channel::<()>(), std::sync::Mutex::new(()));
        let held = released.lock().expect("a lock");
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        std::thread::scope(|scope| {
            for _ in 0..2 * threads {
                let (released, begun) = (&released, release.0.clone());
                scope.spawn(move || {
                    compute(|| {
                        let _ = begun.send(());
                        drop(released.lock());
                    });
                });
            }
            for _ in 0..2 * threads {
                release.1.recv_timeout(Duration::from_secs(20)).expect("it begins");
            }
            let begun = Instant::now();
            let threads: Vec<ThreadId> = (0..1000).into_par_iter().map(|_| std::thread::current().id()).collect();
            assert!(threads.len() == 1000 && begun.elapsed() < Duration::from_secs(10), "the common pool waits for the background");
            drop(held);
        });
    }

    #[test]
    fn work_that_holds_a_lock_waits_for_no_other_work() {
        let (lock, (end, ended)) = (Arc::new(Mutex::new(0)), mpsc::channel());
        for _ in 0..8 {
            let (lock, end) = (lock.clone(), end.clone());
            // Detached, so that the test fails instead of waiting for ever.
            std::thread::spawn(move || {
                for _ in 0..20 {
                    compute(|| {
                        *lock.lock().expect("a lock") += (0..1000).into_par_iter().map(|i: u64| std::hint::black_box(i) % 2).sum::<u64>()
                    });
                }
                let _ = end.send(());
            });
        }
        for _ in 0..8 {
            ended.recv_timeout(Duration::from_secs(60)).expect("the work ends");
        }
        assert_eq!(*lock.lock().expect("a lock"), 8 * 20 * 500);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn background_threads_and_those_that_they_start_yield() {
        let nice = || rustix::process::getpriority_process(None).expect("a nice value");
        let own = nice();
        let [picture, later] =
            [Urgency::Picture, Urgency::Later].map(|urgency| started_as(urgency, || std::thread::scope(|scope| scope.spawn(nice).join())));
        assert_eq!([picture.expect("it ends"), later.expect("it ends")], [own.max(4), own.max(12)]);
        assert_eq!((compute(nice), nice()), (own.max(12), own), "the thread that asks stays as it is");
    }
}
