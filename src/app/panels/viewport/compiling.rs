//! What is compiled for the next picture, over the picture that stays until then.

use egui::{self, Rect, Sense, Ui, vec2};

use crate::app::{shell::state::State, widgets::theme};

/// Seconds between two steps of the spinner. Each step draws the whole window, on the processor
/// that compiles.
const STEP_S: f64 = 0.12;

/// Positions of the spinner's dot.
const STEPS: u32 = 12;

/// Shows a spinner and words at the top of `rect` while something is compiled.
pub fn compiling_ui(ui: &mut Ui, state: &State, rect: Rect) {
    let Some(text) = state
        .picture
        .screen
        .compiling()
        .filter(|_| state.picture.screen.picture().is_some())
    else {
        return;
    };
    egui::Area::new(egui::Id::unique("compiling"))
        .pivot(egui::Align2::CENTER_TOP)
        .fixed_pos(rect.center_top() + vec2(0.0, 44.0))
        .interactable(false)
        .show(ui.ctx(), |ui| {
            theme::toast_frame(theme::accent()).show(ui, |ui| {
                ui.horizontal(|ui| {
                    spinner(ui, state.now_s);
                    ui.label(theme::strong(text));
                });
            });
        });
    ui.request_repaint_after_secs(STEP_S as f32);
}

/// A ring with a dot that runs round it.
fn spinner(ui: &mut Ui, now_s: f64) {
    let (rect, _) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::hover());
    let step = (now_s / STEP_S) as u32 % STEPS;
    let angle = std::f32::consts::TAU * step as f32 / STEPS as f32;
    ui.painter()
        .circle_stroke(rect.center(), 6.0, (1.5, theme::line()));
    ui.painter().circle_filled(
        rect.center() + 6.0 * egui::Vec2::angled(angle),
        2.5,
        theme::accent(),
    );
}
