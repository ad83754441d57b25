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
                    for line in text.lines() {
                        let line = theme::strong(line_without_indent(text, line)).monospace();
                        let is_code = line.text().contains(" |");
                        // A mark below code stays below it.
                        let label = egui::Label::new(line);
                        ui.add(if is_code { label.extend() } else { label });
                    }
                });
            }
        });
}

/// A line of an excerpt of code without the blanks that its code begins with.
fn line_without_indent(excerpt: &str, line: &str) -> String {
    let code = |line: &'_ str| line.split_once("| ").map(|(_, code)| code.to_owned());
    let indents = excerpt.lines().filter_map(code);
    let indent = indents
        .map(|code| code.len() - code.trim_start().len())
        .min();
    match line.split_once("| ") {
        Some((number, code)) => format!("{number}| {}", &code[indent.unwrap_or(0)..]),
        None => line.to_owned(),
    }
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
