//! Computing: how much work keeps the processor busy beside the window. A picture that is measured
//! meanwhile would seem slow.

use std::sync::{
    Arc,
    atomic::{AtomicUsize, Ordering},
};

/// Counts work under way.
#[derive(Clone, Debug, Default)]
pub struct Count(Arc<AtomicUsize>);

/// Work under way, for as long as this exists.
#[derive(Debug)]
pub struct Computing(Count);

impl Count {
    /// Counts work until what is returned is dropped.
    pub fn add(&self) -> Computing {
        self.0.fetch_add(1, Ordering::Relaxed);
        Computing(self.clone())
    }

    pub fn is_any(&self) -> bool {
        self.0.load(Ordering::Relaxed) > 0
    }
}

impl Drop for Computing {
    fn drop(&mut self) {
        self.0.0.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_counts_until_it_is_dropped_even_by_a_panic() {
        let count = Count::default();
        let first = count.add();
        let second = count.add();
        drop(first);
        assert!(count.is_any());
        let panicked = std::thread::spawn(move || {
            let _second = second;
            panic!("work that fails");
        });
        assert!(panicked.join().is_err() && !count.is_any());
    }
}
