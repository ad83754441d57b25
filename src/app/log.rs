//! Messages: all of them in the log, and the outcome of what the user just did as a toast too.

use std::collections::VecDeque;

use eframe::egui::Color32;

use super::{text::first_line, theme};

/// How serious a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    Info,
    Warning,
    Error,
}

impl Level {
    pub fn color(self) -> Color32 {
        match self {
            Self::Info => theme::text_weak(),
            Self::Warning => theme::amber(),
            Self::Error => theme::red(),
        }
    }

    pub const fn word(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A message, and how often it was logged.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub level: Level,
    pub text: String,
    pub count: u32,
}

/// A message that is shown over the picture for a while.
#[derive(Clone, Debug)]
pub struct Toast {
    pub level: Level,
    pub text: String,
    until_s: f64,
}

/// Messages kept; older ones are dropped.
const CAPACITY: usize = 500;

/// Toasts shown at a time; the oldest goes first.
const MAX_TOASTS: usize = 3;

/// Seconds for which a toast is shown.
const TOAST_S: f64 = 4.0;
const ERROR_TOAST_S: f64 = 8.0;

/// The messages of this run.
#[derive(Clone, Debug, Default)]
pub struct Log {
    entries: VecDeque<Entry>,
    toasts: Vec<Toast>,
}

impl Log {
    /// Logs a message. One that was logged before is counted and moves to the end.
    pub fn add(&mut self, level: Level, text: impl Into<String>) {
        let text = text.into();
        let known = self.entries.iter().position(|entry| entry.level == level && entry.text == text);
        let count = known.and_then(|at| self.entries.remove(at)).map_or(1, |entry| entry.count.saturating_add(1));
        self.entries.push_back(Entry { level, text, count });
        if self.entries.len() > CAPACITY {
            self.entries.pop_front();
        }
    }

    /// Logs a message and shows its first line as a toast from `now_s` on.
    pub fn notify(&mut self, level: Level, text: impl Into<String>, now_s: f64) {
        let text = text.into();
        let shown = first_line(&text);
        self.toasts.retain(|toast| toast.text != shown && toast.until_s > now_s);
        let stay_s = if level == Level::Error { ERROR_TOAST_S } else { TOAST_S };
        self.toasts.push(Toast { level, text: shown, until_s: now_s + stay_s });
        self.toasts.drain(..self.toasts.len().saturating_sub(MAX_TOASTS));
        self.add(level, text);
    }

    pub fn entries(&self) -> impl ExactSizeIterator<Item = &Entry> {
        self.entries.iter()
    }

    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Toasts that are shown at `now_s`.
    pub fn toasts(&self, now_s: f64) -> Vec<&Toast> {
        self.toasts.iter().filter(|toast| toast.until_s > now_s).collect()
    }

    /// Seconds from `now_s` until the next toast ends; none without toasts.
    pub fn next_toast_ends_in_s(&self, now_s: f64) -> Option<f64> {
        self.toasts.iter().map(|toast| toast.until_s - now_s).filter(|left_s| *left_s > 0.0).reduce(f64::min)
    }

    /// The whole log as lines of text.
    pub fn to_text(&self) -> String {
        self.entries.iter().map(|Entry { level, text, count }| format!("{}: {text}{}\n", level.word(), times(*count))).collect()
    }
}

/// ` ×3`, or nothing for a single time.
pub fn times(count: u32) -> String {
    if count > 1 { format!(" ×{count}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_message_is_counted_and_not_repeated() {
        let mut log = Log::default();
        log.add(Level::Error, "no such file");
        log.add(Level::Info, "opened");
        log.add(Level::Error, "no such file");
        assert_eq!(log.to_text(), "info: opened\nerror: no such file ×2\n");
    }

    #[test]
    fn a_toast_has_one_line_and_the_log_has_them_all() {
        let mut log = Log::default();
        log.notify(Level::Error, "shader error: no such word\n  ┌─ fog.wgsl:3:9", 0.0);
        assert_eq!(log.toasts[0].text, "shader error: no such word (more in the log)");
        assert!(log.to_text().contains("fog.wgsl:3:9"));
    }

    #[test]
    fn at_most_three_toasts_are_shown_and_the_newest_are() {
        let mut log = Log::default();
        (0..5).for_each(|i| log.notify(Level::Info, i.to_string(), 0.0));
        assert_eq!(log.toasts(1.0).iter().map(|toast| toast.text.as_str()).collect::<Vec<_>>(), ["2", "3", "4"]);
        assert_eq!(log.entries().len(), 5);
    }

    #[test]
    fn the_log_stays_bounded() {
        let mut log = Log::default();
        (0..CAPACITY + 7).for_each(|i| log.add(Level::Info, i.to_string()));
        assert_eq!(log.entries.len(), CAPACITY);
        assert_eq!(log.entries[0].text, "7");
    }
}
