//! The question whether the code of a preset may run: its effects with their sizes, their hooks and
//! their texts.

use egui::{self, RichText, Ui};

use crate::{app::widgets::theme, preset_file::PresetFile};

/// Shows what `preset_file` brings.
pub fn code_ui(ui: &mut Ui, preset_file: &PresetFile) {
    let count = preset_file.brought().count();
    let what = if count == 1 {
        "an effect".to_owned()
    } else {
        format!("{count} effects")
    };
    ui.label(theme::title(format!("{} brings code", preset_file.title())));
    ui.label(theme::weak(format!(
        "This preset contains {what} in WGSL, which would run on this computer's graphics device and processor. Loops are bounded, and files \
         cannot be read. Until you decide, nothing of it runs."
    )));
    ui.add_space(theme::HALF);
    egui::ScrollArea::vertical()
        .max_height(260.0)
        .show(ui, |ui| {
            for effect in preset_file.brought() {
                let Some(source) = &effect.source else {
                    continue;
                };
                let (lines, bytes) = (source.written.lines().count(), source.written.len());
                let s = if lines == 1 { "" } else { "s" };
                let title = format!(
                    "{}: {lines} line{s}, {bytes} bytes, {}",
                    source.stem,
                    effect.hooks.names()
                );
                ui.collapsing(theme::strong(title), |ui| {
                    ui.add(egui::Label::new(RichText::new(&source.written).monospace()).wrap());
                })
                .header_response
                .on_hover_text("Show its text");
            }
        });
}
