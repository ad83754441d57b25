//! The memory budget: how much memory opening a scene may take. It is checked before memory is taken.

use std::{
    fmt,
    str::FromStr,
    sync::{
        OnceLock,
        atomic::{AtomicU64, Ordering},
    },
};

const MIB: u64 = 1 << 20;
const GIB: u64 = 1 << 30;

/// Memory of a machine that does not tell how much it has.
const UNKNOWN_MACHINE: u64 = 8 * GIB;

/// The budget that was chosen for the process; 0 until one is.
static CHOSEN: AtomicU64 = AtomicU64::new(0);

/// How much memory opening a scene may take at its peak.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MemoryBudget(u64);

impl MemoryBudget {
    /// What every machine is expected to have.
    pub const LEAST: Self = Self(1280 * MIB);

    /// A budget of so many bytes, at least [`Self::LEAST`].
    pub fn of(bytes: u64) -> Self {
        Self(bytes).max(Self::LEAST)
    }

    /// The budget of this process: the one that was [chosen](Self::choose), else half of the machine's memory.
    pub fn of_process() -> Self {
        static DEFAULT: OnceLock<MemoryBudget> = OnceLock::new();
        match CHOSEN.load(Ordering::Relaxed) {
            0 => *DEFAULT.get_or_init(|| Self::of(machine_bytes().unwrap_or(UNKNOWN_MACHINE) / 2)),
            bytes => Self(bytes),
        }
    }

    /// Makes it the budget of this process.
    pub fn choose(self) {
        CHOSEN.store(self.0, Ordering::Relaxed);
    }

    /// Bytes that a scene may have once it is open: opening it takes up to 2.5 times as many.
    pub const fn decoded(self) -> u64 {
        self.0 / 5 * 2
    }

    /// What to do about a scene that is larger: a part of a sentence.
    pub fn remedy(self) -> String {
        format!("within the memory budget of {self}; raise it with --memory")
    }
}

impl fmt::Display for MemoryBudget {
    /// `1280 MiB`, `11.8 GiB`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            bytes if bytes < 2 * GIB => write!(f, "{} MiB", bytes / MIB),
            bytes if bytes.is_multiple_of(GIB) => write!(f, "{} GiB", bytes / GIB),
            bytes => write!(f, "{:.1} GiB", bytes as f64 / GIB as f64),
        }
    }
}

impl FromStr for MemoryBudget {
    type Err = String;

    /// Reads a whole or decimal number with the unit MiB, GiB or TiB.
    fn from_str(text: &str) -> Result<Self, String> {
        match read_size(text)? {
            bytes if bytes >= Self::LEAST.0 => Ok(Self(bytes)),
            _ => Err(format!("it must be at least {}", Self::LEAST)),
        }
    }
}

/// Bytes of a whole or decimal number with the unit MiB, GiB or TiB, at most 2^60.
///
/// # Errors
/// It is no such number: what it must be, a part of a sentence.
pub fn read_size(text: &str) -> Result<u64, String> {
    let units = [("MiB", MIB), ("GiB", GIB), ("TiB", 1024 * GIB)];
    let read = |(unit, size): &(&str, u64)| Some(text.strip_suffix(unit)?.trim_end().parse::<f64>().ok()? * *size as f64);
    match units.iter().find_map(read) {
        Some(bytes) if (0.0..=2f64.powi(60)).contains(&bytes) => Ok(bytes as u64),
        _ => Err("it must be a number with a unit, for instance 8GiB or 1500MiB".into()),
    }
}

/// The memory of the machine, or of the group of processes that this one is confined to, bytes. None where the system does not tell.
fn machine_bytes() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let installed = installed_bytes(&read("/proc/meminfo")?)?;
    let confined = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"];
    let confined = confined.iter().find_map(|path| read(path)?.trim().parse::<u64>().ok());
    Some(confined.map_or(installed, |bytes| bytes.min(installed)))
}

/// The total of Linux's `/proc/meminfo`.
fn installed_bytes(meminfo: &str) -> Option<u64> {
    let total = meminfo.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    total.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_read_and_shown_with_their_unit() {
        let shown = |text: &str| text.parse::<MemoryBudget>().map(|budget| budget.to_string());
        assert_eq!(shown("8GiB"), Ok("8 GiB".into()));
        assert_eq!(shown("1500 MiB"), Ok("1500 MiB".into()));
        assert_eq!(shown("2.5GiB"), Ok("2.5 GiB".into()));
        assert_eq!(shown("1TiB"), Ok("1024 GiB".into()));
        assert_eq!(shown("1MiB"), Err("it must be at least 1280 MiB".into()));
        for wrong in ["", "8", "GiB", "8GB", "NaNGiB", "infGiB", "-8GiB", "1e30TiB"] {
            assert!(shown(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_machine_with_little_memory_still_has_the_least_budget() {
        assert_eq!(installed_bytes("MemFree: 1 kB\nMemTotal:       24684084 kB\n"), Some(24_684_084 * 1024));
        assert_eq!(installed_bytes("MemFree: 1 kB"), None);
        assert_eq!(MemoryBudget::of(0), MemoryBudget::LEAST);
        assert_eq!(MemoryBudget::LEAST.decoded(), 512 * MIB);
        assert!(MemoryBudget::of_process() >= MemoryBudget::LEAST);
    }
}
