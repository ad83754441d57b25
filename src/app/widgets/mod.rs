//! What panels are made of: rows, numbers, icons, texts and the theme.

pub mod fields;
pub mod form;
pub mod fuzzy;
pub mod icons;
pub mod numbers;
pub mod panel;
pub mod reveal;
pub mod size;
pub mod text;
pub mod theme;
pub mod tile;

/// Their style, and the sign that fonts may lack.
pub fn apply(ctx: &egui::Context) {
    theme::apply(ctx);
    icons::draw_copy_sign(ctx);
}
