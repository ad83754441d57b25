//! The memory budget: how much memory opening a scene may take. It is checked before memory is
//! taken.

use std::{
    fmt,
    str::FromStr,
    sync::atomic::{AtomicU64, Ordering},
};

const MIB: u64 = 1 << 20;
const GIB: u64 = 1 << 30;

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

    /// The budget of this process: the one that was [chosen](Self::choose), else [`Self::LEAST`].
    pub fn of_process() -> Self {
        Self::of(CHOSEN.load(Ordering::Relaxed))
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
        let how = match cfg!(target_arch = "wasm32") {
            true => "the program can be given more",
            false => "raise it with --memory",
        };
        format!("within the memory budget of {self}; {how}")
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
/// Errors: it is no such number: what it must be, a part of a sentence.
pub fn read_size(text: &str) -> Result<u64, String> {
    let units = [("MiB", MIB), ("GiB", GIB), ("TiB", 1024 * GIB)];
    let read = |(unit, size): &(&str, u64)| {
        Some(text.strip_suffix(unit)?.trim_end().parse::<f64>().ok()? * *size as f64)
    };
    match units.iter().find_map(read) {
        Some(bytes) if (0.0..=2f64.powi(60)).contains(&bytes) => Ok(bytes as u64),
        _ => Err("it must be a number with a unit, for instance 8GiB or 1500MiB".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_read_and_shown_with_their_unit() {
        let shown = |text: &str| {
            text.parse::<MemoryBudget>()
                .map(|budget| budget.to_string())
        };
        assert_eq!(shown("8GiB"), Ok("8 GiB".into()));
        assert_eq!(shown("1500 MiB"), Ok("1500 MiB".into()));
        assert_eq!(shown("2.5GiB"), Ok("2.5 GiB".into()));
        assert_eq!(shown("1TiB"), Ok("1024 GiB".into()));
        assert_eq!(shown("1MiB"), Err("it must be at least 1280 MiB".into()));
        for wrong in [
            "", "8", "GiB", "8GB", "NaNGiB", "infGiB", "-8GiB", "1e30TiB",
        ] {
            assert!(shown(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn no_budget_is_below_the_least() {
        assert_eq!(MemoryBudget::of(0), MemoryBudget::LEAST);
        assert_eq!(MemoryBudget::LEAST.decoded(), 512 * MIB);
        assert!(MemoryBudget::of_process() >= MemoryBudget::LEAST);
    }
}
