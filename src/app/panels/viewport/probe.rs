//! The probe: a click on a judged picture with overlays tells why the pixel shows what it shows.

use egui::{self, Rect, Response, RichText, ScrollArea, Ui};

use super::{loupe::Loupe, overlay_legend::judged_pixel};
use crate::app::{
    picture::apply::look_into,
    picture::apply::mark,
    shell::{command::Commands, state::State},
    widgets::theme,
};

/// Asks about the pixel of the picture at `at` that was clicked.
pub fn take_click(response: &Response, state: &State, at: Rect, commands: &Commands) {
    let clicked = response
        .interact_pointer_pos()
        .filter(|_| response.clicked() && state.picture.overlays.is_any());
    if state.picture.picking.is_none()
        && let Some(pixel) = clicked.and_then(|pointer| judged_pixel(state, at, pointer))
    {
        commands.run(move |app| look_into(&mut app.state, pixel, ""));
    }
}

/// Shows what was told of a pixel, as long as its picture is shown.
pub fn probed_ui(ui: &Ui, loupe: &mut Loupe, state: &State, at: Rect, commands: &Commands) {
    let Some(probed) = state
        .picture
        .probed
        .as_ref()
        .filter(|probed| state.picture.screen.requested() == Some(&probed.of))
    else {
        return;
    };
    let [x, y] = probed.pixel;
    let mut is_open = true;
    egui::Window::new(format!("Why pixel {x}, {y}"))
        .id(egui::Id::unique("probe"))
        .open(&mut is_open)
        .default_pos(at.min + egui::vec2(12.0, 52.0))
        // A table that a narrow picture would cut may lie over the panels beside it.
        .default_width((at.width() - 24.0).clamp(480.0, 760.0))
        .constrain_to(ui.ctx().content_rect())
        .show(ui.ctx(), |ui| {
            if let Some(found) = state.picture.findings() {
                loupe.ui(ui, found, &state.picture.overlays, probed.pixel, commands);
            }
            ScrollArea::both()
                .max_height(0.4 * at.height())
                .show(ui, |ui| {
                    ui.add(
                        egui::Label::new(
                            RichText::new(&probed.text)
                                .monospace()
                                .size(12.0)
                                .color(theme::text()),
                        )
                        .wrap_mode(egui::TextWrapMode::Extend),
                    );
                });
            if ui.button("Copy").clicked() {
                ui.ctx().copy_text(probed.text.clone());
            }
        });
    if !is_open {
        commands.run(|app| mark(&mut app.state, None));
    }
}
