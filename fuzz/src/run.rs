//! One input on one target: panics, time and memory.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    time::{Duration, Instant},
};

use crate::{
    Target, guard,
    targets::{Outcome, assert_told_with_place},
};

/// What an input cost.
#[derive(Clone, Debug)]
pub struct Cost {
    pub time: Duration,
    /// The most bytes held at once.
    pub bytes: usize,
    /// Whether it was accepted.
    pub outcome: Outcome,
}

/// Runs `target` on `input`.
///
/// # Errors
/// What went wrong, in a sentence: a panic, a broken promise, too much time or memory.
pub fn check(target: &Target, input: &[u8]) -> Result<Cost, String> {
    let (before, start) = (guard::begin(), Instant::now());
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        let outcome = (target.check)(input);
        if let Err(refusal) = &outcome {
            assert_told_with_place(refusal);
        }
        outcome
    }));
    let (time, bytes) = (start.elapsed(), guard::most_since(before));
    let outcome = outcome.map_err(|panic| {
        let said = panic
            .downcast_ref::<String>()
            .cloned()
            .or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
        format!("panic: {}", said.unwrap_or_default())
    })?;
    let cost = Cost {
        time,
        bytes,
        outcome,
    };
    if cost.time > target.limit.time {
        return Err(format!(
            "it took {:.1} s; allowed: {:.0} s",
            cost.time.as_secs_f64(),
            target.limit.time.as_secs_f64()
        ));
    }
    if cost.bytes > target.limit.bytes {
        return Err(format!(
            "it took {} MiB of memory; allowed: {} MiB",
            cost.bytes >> 20,
            target.limit.bytes >> 20
        ));
    }
    Ok(cost)
}
