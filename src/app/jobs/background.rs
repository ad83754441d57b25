//! Background work: pools of their own for the oracle's pictures, and threads that leave the
//! processor to all others.
//!
//! The window's thread uses the common pool for moments (a pick, the image of an overlay). A
//! picture of the oracle there would keep it waiting, for seconds with a large one.

/// From now on this thread, and every thread that it starts, leaves the processor to all others:
/// for work that may take any time. Drivers start threads, too: a device that is opened afterwards
/// is as patient. On Linux alone; other systems with a CPU adapter are rare.
pub fn yield_processor() {
    // Refused only by a sandbox; then it is as urgent as before.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(19);
}

/// Runs `work` in a pool of its own and waits for it; never on the thread of the window.
///
/// In a pool that all work shares, a thread that waits for the parts of one picture takes up other
/// work meanwhile; that work may wait for a lock which the same thread holds.
pub fn compute<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    #[cfg(not(target_arch = "wasm32"))]
    if let Ok(pool) = rayon::ThreadPoolBuilder::new()
        .thread_name(|i| format!("background {i}"))
        .build()
    {
        return pool.install(work);
    }
    work()
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
                release
                    .1
                    .recv_timeout(Duration::from_secs(20))
                    .expect("it begins");
            }
            let begun = Instant::now();
            let threads: Vec<ThreadId> = (0..1000)
                .into_par_iter()
                .map(|_| std::thread::current().id())
                .collect();
            assert!(
                threads.len() == 1000 && begun.elapsed() < Duration::from_secs(10),
                "the common pool waits for the background"
            );
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
                        *lock.lock().expect("a lock") += (0..1000)
                            .into_par_iter()
                            .map(|i: u64| std::hint::black_box(i) % 2)
                            .sum::<u64>()
                    });
                }
                let _ = end.send(());
            });
        }
        for _ in 0..8 {
            ended
                .recv_timeout(Duration::from_secs(60))
                .expect("the work ends");
        }
        assert_eq!(*lock.lock().expect("a lock"), 8 * 20 * 500);
    }
}
