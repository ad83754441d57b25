//! Badges over the picture: what is wrong with files that it depends on, until that is mended.

use egui::{self, Rect, RichText, Ui};

use crate::app::{files::live::Subject, shell::state::State, widgets::theme};

/// Shows the badges at the lower left of `rect`.
pub fn badges_ui(ui: &mut Ui, state: &State, rect: Rect) {
    let stack = &state.session.preset().stack;
    let faults: Vec<(&Subject, &str)> = state
        .files
        .live
        .shown_faults(|name| stack.get(name).is_some())
        .collect();
    if faults.is_empty() {
        return;
    }
    egui::Area::new(egui::Id::unique("badges"))
        .pivot(egui::Align2::LEFT_BOTTOM)
        .fixed_pos(rect.left_bottom() + egui::vec2(12.0, -12.0))
        .interactable(false)
        .show(ui.ctx(), |ui| {
            ui.set_max_width((rect.width() - 48.0).max(160.0));
            for (subject, text) in faults {
                theme::toast_frame(theme::red()).show(ui, |ui| {
                    ui.label(RichText::new(title(subject)).color(theme::red()).strong());
                    ui.label(theme::strong(text).monospace());
                });
            }
        });
}

fn title(subject: &Subject) -> String {
    match subject {
        Subject::Effect(name) => {
            format!("{name}.wgsl is faulty; the picture shows the last good version")
        }
        Subject::Pipelines => {
            "An effect cannot be compiled; the picture shows the last good version".into()
        }
        Subject::Preset => {
            "The preset's file is faulty; the picture shows the last good version".into()
        }
        Subject::Model => {
            "The model's file is faulty; the picture shows the last good version".into()
        }
        Subject::Shaders => {
            "The shaders are faulty; the picture shows the last good version".into()
        }
    }
}
