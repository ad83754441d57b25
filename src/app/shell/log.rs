//! Messages: all of them in the log, and the outcome of what the user just did as a toast too.

use std::{collections::VecDeque, fs::File, io::Write as _, sync::Arc};

use egui::Color32;

use crate::app::widgets::{
    text::{first_line, with_own_paths},
    theme,
};

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
    /// Each message is appended to it as a line.
    file: Option<Arc<File>>,
}

impl Log {
    /// An empty log whose messages are appended to `file`.
    pub fn kept_in(file: Option<Arc<File>>) -> Self {
        Self {
            file,
            ..Self::default()
        }
    }

    fn append(&mut self, line: &str) {
        let Some(mut file) = self.file.as_deref() else {
            return;
        };
        if let Err(error) = file.write_all(line.as_bytes()) {
            self.file = None;
            self.add(
                Level::Error,
                format!("The log is no longer kept in its file: {error}"),
            );
        }
    }

    /// Logs a message. One that was logged before is counted and moves to the end.
    pub fn add(&mut self, level: Level, text: impl Into<String>) {
        // A library may write a message of several lines; the log has one line for each message.
        let text = with_own_paths(text.into());
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let text = lines.collect::<Vec<_>>().join(" · ");
        self.append(&format!("{}: {text}\n", level.word()));
        let known = self
            .entries
            .iter()
            .position(|entry| entry.level == level && entry.text == text);
        let count = known
            .and_then(|at| self.entries.remove(at))
            .map_or(1, |entry| entry.count.saturating_add(1));
        self.entries.push_back(Entry { level, text, count });
        if self.entries.len() > CAPACITY {
            self.entries.pop_front();
        }
    }

    /// Logs a message and shows its first line as a toast from `now_s` on.
    pub fn notify(&mut self, level: Level, text: impl Into<String>, now_s: f64) {
        let text = with_own_paths(text.into());
        let shown = first_line(&text);
        self.toasts
            .retain(|toast| toast.text != shown && toast.until_s > now_s);
        let stay_s = if level == Level::Error {
            ERROR_TOAST_S
        } else {
            TOAST_S
        };
        self.toasts.push(Toast {
            level,
            text: shown,
            until_s: now_s + stay_s,
        });
        self.toasts
            .drain(..self.toasts.len().saturating_sub(MAX_TOASTS));
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
        self.toasts
            .iter()
            .filter(|toast| toast.until_s > now_s)
            .collect()
    }

    /// Seconds from `now_s` until the next toast ends; none without toasts.
    pub fn next_toast_ends_in_s(&self, now_s: f64) -> Option<f64> {
        self.toasts
            .iter()
            .map(|toast| toast.until_s - now_s)
            .filter(|left_s| *left_s > 0.0)
            .reduce(f64::min)
    }

    /// The whole log as lines of text.
    pub fn to_text(&self) -> String {
        self.entries
            .iter()
            .map(|Entry { level, text, count }| {
                format!("{}: {text}{}\n", level.word(), times(*count))
            })
            .collect()
    }
}

/// ` ×3`, or nothing for a single time.
pub fn times(count: u32) -> String {
    if count > 1 {
        format!(" ×{count}")
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_is_appended_to_the_file_of_the_log() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("window.log");
        for run in 0..2 {
            let file = File::options()
                .create(true)
                .append(true)
                .open(&path)
                .expect("a file");
            let mut log = Log::kept_in(Some(Arc::new(file)));
            log.add(Level::Info, "opened");
            log.notify(Level::Error, "no such file", 0.0);
            log.clear();
            assert_eq!(
                std::fs::read_to_string(&path)
                    .expect("a file")
                    .lines()
                    .count(),
                2 * (run + 1)
            );
            assert_eq!(log.entries().len(), 0);
        }
        assert!(
            std::fs::read_to_string(&path)
                .expect("a file")
                .ends_with("info: opened\nerror: no such file\n")
        );
        // A file that cannot be written is given up once, in words.
        let read_only = File::open(&path).expect("a file");
        let mut log = Log::kept_in(Some(Arc::new(read_only)));
        log.add(Level::Info, "opened");
        log.add(Level::Info, "closed");
        assert_eq!(
            log.entries()
                .filter(|entry| entry.text.contains("no longer kept"))
                .count(),
            1
        );
    }

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
        log.notify(
            Level::Error,
            "shader error: no such word\n  ┌─ fog.wgsl:3:9",
            0.0,
        );
        assert_eq!(
            log.toasts[0].text,
            "shader error: no such word (more in the log)"
        );
        assert!(log.to_text().contains("fog.wgsl:3:9"));
    }

    #[test]
    fn at_most_three_toasts_are_shown_and_the_newest_are() {
        let mut log = Log::default();
        (0..5).for_each(|i| log.notify(Level::Info, i.to_string(), 0.0));
        assert_eq!(
            log.toasts(1.0)
                .iter()
                .map(|toast| toast.text.as_str())
                .collect::<Vec<_>>(),
            ["2", "3", "4"]
        );
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
