//! Background work: threads that yield the processor to the window, and a pool of their own for the oracle's pictures.
//!
//! The window's thread uses the common pool for moments (a pick, the image of an overlay). A picture of the oracle there would keep it
//! waiting, for seconds with a large one.

use std::sync::OnceLock;

use rayon::{ThreadPool, ThreadPoolBuilder};

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

/// Runs `work` in the pool for background work and waits for it; never on the thread of the window.
pub fn compute<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static POOL: OnceLock<Option<ThreadPool>> = OnceLock::new();
    let pool = POOL.get_or_init(|| {
        let builder = ThreadPoolBuilder::new().thread_name(|i| format!("background {i}"));
        builder.start_handler(|_| yield_processor(Urgency::Later)).build().ok()
    });
    match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

#[cfg(test)]
mod tests {
    use std::{
        sync::mpsc,
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
            // Every thread of the background pool is busy now.
            for _ in 0..threads {
                release.1.recv_timeout(Duration::from_secs(20)).expect("it begins");
            }
            let begun = Instant::now();
            let threads: Vec<ThreadId> = (0..1000).into_par_iter().map(|_| std::thread::current().id()).collect();
            assert!(threads.len() == 1000 && begun.elapsed() < Duration::from_secs(10), "the common pool waits for the background");
            drop(held);
        });
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
