//! What the lab tells people: everything in the log, the outcome of what they just did also as a toast.

use std::collections::VecDeque;

use eframe::egui::{self, RichText};

use super::{
    icons::{Icon, icon_button},
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
    fn color(self) -> egui::Color32 {
        match self {
            Self::Info => theme::TEXT_WEAK,
            Self::Warning => theme::AMBER,
            Self::Error => theme::RED,
        }
    }

    const fn word(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A message, and how often it came.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub level: Level,
    pub text: String,
    pub count: u32,
}

#[derive(Clone, Debug)]
struct Toast {
    level: Level,
    text: String,
    until_s: f64,
}

/// Messages kept; older ones are dropped.
const CAPACITY: usize = 500;

/// How long a toast stays.
const TOAST_S: f64 = 4.0;
const ERROR_TOAST_S: f64 = 8.0;

/// The messages of this run.
#[derive(Clone, Debug, Default)]
pub struct Log {
    entries: VecDeque<Entry>,
    toasts: Vec<Toast>,
}

impl Log {
    /// Adds a message; one that is there already is counted and moves to the end.
    pub fn add(&mut self, level: Level, text: impl Into<String>) {
        let text = text.into();
        let known = self.entries.iter().position(|entry| entry.level == level && entry.text == text);
        let count = known.and_then(|at| self.entries.remove(at)).map_or(1, |entry| entry.count.saturating_add(1));
        self.entries.push_back(Entry { level, text, count });
        if self.entries.len() > CAPACITY {
            self.entries.pop_front();
        }
    }

    /// Adds a message and shows it for a while: the outcome of what the user just did.
    pub fn tell(&mut self, level: Level, text: impl Into<String>, now_s: f64) {
        let text = text.into();
        let shown = first_line(&text);
        self.toasts.retain(|toast| toast.text != shown);
        let stay_s = if level == Level::Error { ERROR_TOAST_S } else { TOAST_S };
        self.toasts.push(Toast { level, text: shown, until_s: now_s + stay_s });
        self.add(level, text);
    }

    /// The whole log as lines of text.
    pub fn to_text(&self) -> String {
        self.entries.iter().map(|Entry { level, text, count }| format!("{}: {text}{}\n", level.word(), times(*count))).collect()
    }

    /// Shows what was just told in the lower left of `area`; asks to be shown again when the next toast ends.
    pub fn toasts_ui(&mut self, ctx: &egui::Context, area: egui::Rect, now_s: f64) {
        self.toasts.retain(|toast| toast.until_s > now_s);
        let Some(next_s) = self.toasts.iter().map(|toast| toast.until_s).reduce(f64::min) else { return };
        ctx.request_repaint_after_secs((next_s - now_s) as f32);
        egui::Area::new(egui::Id::unique("toasts"))
            .order(egui::Order::Foreground)
            .pivot(egui::Align2::CENTER_BOTTOM)
            .fixed_pos(area.center_bottom() - egui::vec2(0.0, 16.0))
            .interactable(false)
            .show(ctx, |ui| {
                ui.set_max_width((area.width() - 32.0).clamp(200.0, 560.0));
                for toast in &self.toasts {
                    theme::toast_frame(toast.level.color()).show(ui, |ui| ui.label(RichText::new(&toast.text).color(theme::TEXT_STRONG)));
                }
            });
    }

    /// The log panel.
    pub fn panel_ui(&mut self, ui: &mut egui::Ui) {
        ui.horizontal(|ui| {
            ui.label(theme::heading("Log"));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if icon_button(ui, Icon::Cross, "Clear the log").clicked() {
                    self.entries.clear();
                }
                if ui.small_button("Copy").on_hover_text("Copy the whole log").clicked() {
                    ui.ctx().copy_text(self.to_text());
                }
            });
        });
        egui::ScrollArea::vertical().auto_shrink(false).stick_to_bottom(true).show(ui, |ui| {
            if self.entries.is_empty() {
                ui.label(theme::weak("Nothing to report. Loading, saving and every error end up here."));
            }
            for Entry { level, text, count } in &self.entries {
                ui.horizontal_wrapped(|ui| {
                    ui.spacing_mut().item_spacing.x = 8.0;
                    ui.label(RichText::new(level.word()).monospace().color(level.color()));
                    ui.label(RichText::new(text).monospace().color(theme::TEXT));
                    ui.label(theme::weak(times(*count)));
                });
            }
        });
    }
}

/// What a toast says of a message of several lines, such as a shader's error with its snippet.
pub fn first_line(text: &str) -> String {
    match text.split_once('\n') {
        Some((first, _)) => format!("{} (more in the log)", first.trim_end()),
        None => text.to_owned(),
    }
}

/// ` ×3`, or nothing for a single time.
fn times(count: u32) -> String {
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
        log.tell(Level::Error, "shader error: no such word\n  ┌─ fog.wgsl:3:9", 0.0);
        assert_eq!(log.toasts[0].text, "shader error: no such word (more in the log)");
        assert!(log.to_text().contains("fog.wgsl:3:9"));
    }

    #[test]
    fn the_log_stays_bounded() {
        let mut log = Log::default();
        (0..CAPACITY + 7).for_each(|i| log.add(Level::Info, i.to_string()));
        assert_eq!(log.entries.len(), CAPACITY);
        assert_eq!(log.entries[0].text, "7");
    }
}
