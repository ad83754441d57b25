//! The folder of the overlays: which are shown, and how many pixels each paints.

use egui::{RichText, Ui};

use crate::app::{
    picture::overlay::Overlay,
    shell::{action::Action, command::Commands, state::State},
    widgets::{form::gain_ui, icons::swatch, panel::at_right, text::group_digits, theme},
};

pub fn overlays_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let findings = state.picture.findings();
    for overlay in Overlay::listed() {
        if overlay == Overlay::Ties {
            ui.add_space(theme::HALF);
        }
        ui.horizontal(|ui| {
            ui.set_min_height(theme::ROW);
            ui.spacing_mut().item_spacing.x = 6.0;
            let mut on = state.picture.overlays.contains(overlay);
            let label = format!("Overlay {}", overlay.name().to_lowercase());
            if ui
                .checkbox(&mut on, overlay.name())
                .on_hover_text(overlay.doc())
                .accessible_name(label)
                .clicked()
            {
                commands.run(move |app| app.state.picture.overlays.set(overlay, on));
            }
            swatch(ui, overlay.color());
            if overlay == Overlay::Color {
                let mut gain = state.picture.overlays.gain;
                let hint = "Factor of the color difference";
                if gain_ui(ui, "Overlay gain", &mut gain, hint).changed() {
                    commands.run(move |app| app.state.picture.overlays.gain = gain);
                }
            }
            if let Some(findings) = findings {
                let count = findings.count(overlay);
                let is_bad = overlay.is_error() && overlay.fault().is_some() && count > 0;
                at_right(ui, |ui| {
                    let text = RichText::new(group_digits(count)).monospace();
                    ui.label(text.color(if is_bad {
                        theme::red()
                    } else {
                        theme::text_weak()
                    }))
                    .on_hover_text("pixels");
                });
            }
        });
    }
    ui.add_space(theme::HALF);
    let open = &state.open;
    ui.horizontal(|ui| {
        for (mut on, name, action) in [
            (open.bounding_box, "Box", Action::BoundingBox),
            (open.axes, "Axes", Action::Axes),
            (open.grid, "Grid", Action::Grid),
        ] {
            let toggle = ui.checkbox(&mut on, name).on_hover_text(action.hint());
            let label = format!("Guide {}", name.to_lowercase());
            if toggle.accessible_name(label).clicked() {
                commands.perform(action);
            }
        }
    });
    if findings.is_none() {
        ui.label(theme::weak(
            "To count pixels, show an overlay or press Verify.",
        ));
    }
}
