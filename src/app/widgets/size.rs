//! The size of a picture: width and height as numbers, or one of the sizes that have a name.

use eframe::egui::{ComboBox, DragValue, Ui};

use crate::preset::{NAMED_SIZES, named_size};

/// The sizes by name; choosing one sets `size`. `of` says what has the size.
fn names_ui(ui: &mut Ui, of: &str, size: &mut [u32; 2]) {
    let is_chosen = |(_, named): &&(&str, [u32; 2])| named == size;
    let chosen = NAMED_SIZES.iter().find(is_chosen);
    let menu = ComboBox::from_id_salt(("named size", of))
        .selected_text(chosen.map_or("own size", |(name, _)| *name))
        .width(88.0)
        .show_ui(ui, |ui| {
            for (name, [width, height]) in NAMED_SIZES {
                let is_chosen = named_size(name) == Some(*size);
                let label = format!("{name}: {width} \u{d7} {height}");
                if ui.selectable_label(is_chosen, label).clicked() {
                    *size = [width, height];
                }
            }
        });
    menu.response
        .accessible_name(format!("Size of {of} by name"));
}

/// Width and height in pixels from `step` to `most`, both whole multiples of `step`.
pub fn size_ui(ui: &mut Ui, of: &str, size: &mut [u32; 2], step: u32, most: u32) {
    for (side, name) in size.iter_mut().zip(["Width", "Height"]) {
        ui.add(DragValue::new(side).range(step..=most).suffix(" px"))
            .accessible_name(format!("{name} of {of}"));
        *side -= *side % step.max(1);
    }
    names_ui(ui, of, size);
}
