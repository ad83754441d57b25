//! What Linux tells of this process.

use std::fs;

/// Memory of this process that does not come from files, MB.
pub fn resident_mb() -> f64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("RssAnon:"))
        .expect("its anonymous memory");
    line.trim()
        .trim_end_matches("kB")
        .trim()
        .parse::<f64>()
        .expect("a number")
        / 1024.0
}
