//! Ending: threads that are told to end while the window goes on, and the wait for them when it
//! closes. A driver must not be unloaded under a thread that compiles.

use std::{
    sync::{Mutex, PoisonError},
    thread::JoinHandle,
    time::Duration,
};

use web_time::Instant;

/// How long the window waits for its threads when it closes.
const PATIENCE: Duration = Duration::from_secs(20);

/// Threads that were told to end. Dropping this waits for them, so the last owner does that when
/// the window closes.
#[derive(Debug, Default)]
pub struct EndingThreads(Mutex<Vec<JoinHandle<()>>>);

impl EndingThreads {
    /// Takes a thread that was told to end; does not wait.
    pub fn add(&self, thread: JoinHandle<()>) {
        let mut threads = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        threads.retain(|thread| !thread.is_finished());
        threads.push(thread);
    }
}

impl Drop for EndingThreads {
    fn drop(&mut self) {
        let threads = self.0.get_mut().unwrap_or_else(PoisonError::into_inner);
        let begun = Instant::now();
        while threads.iter().any(|thread| !thread.is_finished()) && begun.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc,
    };

    use super::*;

    #[test]
    fn the_last_owner_waits_and_the_others_do_not() {
        let (ending, has_ended) = (
            Arc::new(EndingThreads::default()),
            Arc::new(AtomicBool::new(false)),
        );
        let (release, held) = mpsc::channel::<()>();
        let flag = has_ended.clone();
        let thread = std::thread::spawn(move || {
            held.recv().expect("a word");
            flag.store(true, Ordering::Relaxed);
        });
        let other = ending.clone();
        other.add(thread);
        drop(other);
        assert!(!has_ended.load(Ordering::Relaxed));
        release.send(()).expect("the thread listens");
        drop(ending);
        assert!(has_ended.load(Ordering::Relaxed));
    }
}
