//! The memory of the machine.

use crate::scene::memory::MemoryBudget;

/// Memory of a machine that does not tell how much it has, bytes.
const UNKNOWN_MACHINE: u64 = 8 << 30;

/// Half of the machine's memory.
pub fn machine_budget() -> MemoryBudget {
    MemoryBudget::of(machine_bytes().unwrap_or(UNKNOWN_MACHINE) / 2)
}

/// The memory of the machine, or of the group of processes that this one is confined to, bytes.
/// None where the system does not tell.
fn machine_bytes() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let installed = installed_bytes(&read("/proc/meminfo")?)?;
    let confined = [
        "/sys/fs/cgroup/memory.max",
        "/sys/fs/cgroup/memory/memory.limit_in_bytes",
    ];
    let confined = confined
        .iter()
        .find_map(|path| read(path)?.trim().parse::<u64>().ok());
    Some(confined.map_or(installed, |bytes| bytes.min(installed)))
}

/// The total of Linux's `/proc/meminfo`.
fn installed_bytes(meminfo: &str) -> Option<u64> {
    let total = meminfo
        .lines()
        .find_map(|line| line.strip_prefix("MemTotal:"))?;
    total
        .trim()
        .strip_suffix("kB")?
        .trim()
        .parse::<u64>()
        .ok()?
        .checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_of_a_machine_is_read_where_it_tells() {
        assert_eq!(
            installed_bytes("MemFree: 1 kB\nMemTotal:       24684084 kB\n"),
            Some(24_684_084 * 1024)
        );
        assert_eq!(installed_bytes("MemFree: 1 kB"), None);
        assert!(machine_budget() >= MemoryBudget::LEAST);
    }
}
