//! The memory that buffers and textures take on a device, and the most that they may.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

/// Most bytes on devices that are opened from now on; the largest number: as many as there are.
static CHOSEN: AtomicU64 = AtomicU64::new(u64::MAX);

/// Makes it the most bytes that buffers and textures may take on each device that is opened from
/// now on.
pub fn choose_device_memory(bytes: u64) {
    CHOSEN.store(bytes, Ordering::Relaxed);
}

/// The memory of one device.
#[derive(Debug)]
pub struct DeviceMemory {
    used: Arc<AtomicU64>,
    most: AtomicU64,
}

/// Bytes that are taken until this is dropped.
#[derive(Debug)]
pub struct Reserved {
    used: Arc<AtomicU64>,
    bytes: u64,
}

impl Default for DeviceMemory {
    fn default() -> Self {
        Self {
            used: Arc::default(),
            most: AtomicU64::new(CHOSEN.load(Ordering::Relaxed)),
        }
    }
}

impl DeviceMemory {
    /// Takes so many bytes; none where that would be more than are allowed.
    pub fn reserve(&self, bytes: u64) -> Option<Reserved> {
        let most = self.most.load(Ordering::Relaxed);
        let take = |used: u64| used.checked_add(bytes).filter(|sum| *sum <= most);
        self.used
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take)
            .ok()?;
        Some(Reserved {
            used: self.used.clone(),
            bytes,
        })
    }

    /// Allows so many bytes from now on. What is taken stays.
    pub fn allow(&self, bytes: u64) {
        self.most.store(bytes, Ordering::Relaxed);
    }

    /// Bytes that are taken.
    pub fn used(&self) -> u64 {
        self.used.load(Ordering::Relaxed)
    }
}

impl Drop for Reserved {
    fn drop(&mut self) {
        self.used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_is_reserved_than_allowed_and_what_is_dropped_is_free_again() {
        let memory = DeviceMemory::default();
        memory.allow(100);
        let first = memory.reserve(60).expect("60 of 100");
        assert!(memory.reserve(41).is_none() && memory.reserve(u64::MAX).is_none());
        let second = memory.reserve(40).expect("40 of 40");
        drop(first);
        assert_eq!(memory.used(), 40);
        drop(second);
        assert_eq!(memory.used(), 0);
    }
}
