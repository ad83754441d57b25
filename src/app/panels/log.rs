//! The log panel, and the toasts over the picture.

use egui::{self, Rect, RichText, Ui};

use crate::app::panels::panel::Panel;
use crate::app::{
    shell::{
        command::Commands,
        log::{Entry, Log, times},
        state::State,
    },
    widgets::{
        icons::{Icon, icon_button},
        panel::at_right,
        theme,
    },
};

/// Lists every message.
pub struct LogPanel;

impl Panel for LogPanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        let log = &state.log;
        ui.horizontal(|ui| {
            ui.label(theme::heading("Log"));
            at_right(ui, |ui| {
                if icon_button(ui, Icon::Cross, "Clear the log").clicked() {
                    commands.run(|app| app.state.log.clear());
                }
                if ui
                    .small_button("Copy")
                    .on_hover_text("Copy the whole log")
                    .clicked()
                {
                    ui.ctx().copy_text(log.to_text());
                }
            });
        });
        egui::ScrollArea::vertical()
            .auto_shrink(false)
            .stick_to_bottom(true)
            .show(ui, |ui| {
                if log.entries().len() == 0 {
                    ui.label(theme::weak(
                        "No messages yet. Loading, saving and every error are reported here.",
                    ));
                }
                for Entry { level, text, count } in log.entries() {
                    ui.horizontal_wrapped(|ui| {
                        ui.spacing_mut().item_spacing.x = 8.0;
                        ui.label(RichText::new(level.word()).monospace().color(level.color()));
                        ui.label(RichText::new(text).monospace().color(theme::text()));
                        ui.label(theme::weak(times(*count)));
                    });
                }
            });
    }
}

/// Shows the toasts at the upper right of `area`, below the buttons and what is compiled, and repaints
/// when the next one ends.
pub fn toasts_ui(ctx: &egui::Context, log: &Log, area: Rect, now_s: f64) {
    let Some(wait_s) = log.next_toast_ends_in_s(now_s) else {
        return;
    };
    ctx.request_repaint_after_secs(wait_s as f32);
    egui::Area::new(egui::Id::unique("toasts"))
        .order(egui::Order::Foreground)
        .pivot(egui::Align2::RIGHT_TOP)
        .fixed_pos(area.right_top() + egui::vec2(-10.0, 84.0))
        .interactable(false)
        .show(ctx, |ui| {
            ui.set_max_width((area.width() - 20.0).clamp(160.0, 380.0));
            for toast in log.toasts(now_s) {
                theme::toast_frame(toast.level.color())
                    .show(ui, |ui| ui.label(theme::strong(&toast.text)));
            }
        });
}
