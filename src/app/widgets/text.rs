//! Numbers as people read them.

pub use crate::params::group_digits;

/// `1.5 MiB`.
pub fn bytes(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} B"),
        1024..1_048_576 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        _ => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
    }
}

/// `0.05`, `3.5`, `1200`: three significant digits.
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A text in which files that a page was given have the paths that a person knows: their names.
pub fn with_own_paths(text: String) -> String {
    match cfg!(target_arch = "wasm32") {
        true => text.replace("/given/", ""),
        false => text,
    }
}

/// A path, or another text whose ends tell most, in at most `max` characters: cut in its middle.
pub fn cut_middle(text: &str, max: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= max {
        return text.to_owned();
    }
    // The end of a path tells more than its beginning.
    let kept = max.saturating_sub(1);
    let first = kept / 3;
    let last = &letters[letters.len() - (kept - first)..];
    letters[..first].iter().chain(&['…']).chain(last).collect()
}

/// The first line of a message, and that there is more.
pub fn first_line(text: &str) -> String {
    match text.split_once('\n') {
        Some((first, _)) => format!("{} (more in the log)", first.trim_end()),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_grouped_by_three() {
        assert_eq!(
            [group_digits(7), group_digits(1000), group_digits(1_234_567)],
            ["7", "1,000", "1,234,567"]
        );
    }

    #[test]
    fn long_paths_are_cut_in_their_middle() {
        let path = "/home/ada/models/animals/fox.glb";
        assert_eq!(cut_middle(path, 40), path);
        assert_eq!(cut_middle(path, 19), "/home/…mals/fox.glb");
        assert_eq!(cut_middle("äöüß", 3), "…ß".replace('…', "…ü"));
    }

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            [0.0, 0.0512, 3.5, 12.0, 99.96, 1234.6].map(short),
            ["0", "0.0512", "3.5", "12", "100", "1235"]
        );
    }
}
