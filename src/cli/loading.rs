//! Loading a scene: a progress bar where it takes longer than a moment.

use std::{
    sync::{Arc, mpsc},
    time::Duration,
};

use super::streams::Streams;
use crate::work::Work;

/// Below this nothing is shown.
const MOMENT: Duration = Duration::from_millis(500);
/// Between two looks at how far it has come.
const STEP: Duration = Duration::from_millis(100);

/// Runs `load` and shows its progress in bytes, with the time left.
pub fn watched<T>(streams: &Streams, load: impl FnOnce() -> T) -> T {
    let work = Arc::new(Work::default());
    let bar = streams.byte_progress();
    let (end, ended) = mpsc::channel::<()>();
    std::thread::scope(|scope| {
        let watched = work.clone();
        scope.spawn(move || {
            let mut wait = MOMENT;
            while ended.recv_timeout(wait) == Err(mpsc::RecvTimeoutError::Timeout) {
                wait = STEP;
                if let Some(progress) = watched.progress() {
                    bar.set_length(progress.expected);
                    bar.set_position(progress.done);
                    bar.set_message(format!("loading {progress}"));
                }
            }
            bar.finish_and_clear();
        });
        // Dropped also where loading unwinds, so that the bar ends.
        let _end = end;
        work.run_to_its_end(load)
    })
}
