//! The size of a picture: width and height as numbers, or one of the sizes that have a name.

use egui::Ui;

use super::form::{menu_ui, number_ui};
use crate::preset::NAMED_SIZES;

/// Width and height in pixels from `step` to `most`, both whole multiples of `step`; `of` says what
/// has the size. A number is rounded when its field is left; returns what to say about it.
pub fn size_ui(ui: &mut Ui, of: &str, size: &mut [u32; 2], step: u32, most: u32) -> Option<String> {
    let mut said = None;
    for (side, name) in size.iter_mut().zip(["Width", "Height"]) {
        let name = format!("{name} of {of}");
        let field = number_ui(ui, &name, side, step..=most, (1.0, " px"));
        let rounded = *side - *side % step.max(1);
        if rounded != *side && !field.has_focus() {
            if field.lost_focus() {
                said = Some(format!(
                    "{name} takes multiples of {step}: {side} became {rounded}."
                ));
            }
            *side = rounded;
        }
    }
    let now = NAMED_SIZES.iter().find(|(_, named)| named == size);
    let now = now.map_or("own size", |(name, _)| *name);
    let sizes = NAMED_SIZES.iter().map(|(name, [width, height])| {
        let label = format!("{name}: {width} \u{d7} {height}");
        ([*width, *height], label, "")
    });
    let name = format!("Size of {of} by name");
    if let (Some(named), _) = menu_ui(ui, &name, (now, 88.0), Some(size), sizes) {
        *size = named;
    }
    said
}
