//! The visual style of the lab: dark neutral grays that leave the colors to the picture, one accent, an 8-point grid.

use eframe::egui::{self, Color32, CornerRadius, FontFamily, FontId, Margin, RichText, Stroke, TextStyle, vec2};

/// Behind the picture.
pub const VIEW: Color32 = Color32::from_rgb(16, 17, 20);
/// Panels.
pub const PANEL: Color32 = Color32::from_rgb(27, 28, 32);
/// Bars at the top and bottom, group headers.
pub const BAR: Color32 = Color32::from_rgb(33, 34, 39);
/// Wells: rails, text fields.
pub const WELL: Color32 = Color32::from_rgb(17, 18, 21);
/// Buttons at rest and hovered.
pub const RAISED: Color32 = Color32::from_rgb(46, 48, 54);
pub const RAISED_HOVER: Color32 = Color32::from_rgb(60, 63, 71);
/// Separators.
pub const LINE: Color32 = Color32::from_rgb(48, 50, 56);

pub const TEXT_STRONG: Color32 = Color32::from_rgb(244, 245, 247);
pub const TEXT: Color32 = Color32::from_rgb(206, 209, 215);
/// 4.9:1 on [`PANEL`]: secondary, and still readable.
pub const TEXT_WEAK: Color32 = Color32::from_rgb(143, 148, 158);

/// The one accent: selection, changed values, focus.
pub const ACCENT: Color32 = Color32::from_rgb(94, 168, 255);
/// The accent as a background of text.
pub const ACCENT_GROUND: Color32 = Color32::from_rgb(33, 66, 112);
pub const AMBER: Color32 = Color32::from_rgb(240, 178, 74);
pub const RED: Color32 = Color32::from_rgb(255, 115, 108);
pub const GREEN: Color32 = Color32::from_rgb(122, 201, 143);

/// Half a grid step: between parts of a group.
pub const HALF: f32 = 4.0;
/// The grid.
pub const GAP: f32 = 8.0;
/// Height of a row of controls.
pub const ROW: f32 = 24.0;

/// Applies the theme to egui's dark and light styles, so that a light desktop does not change it.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.visuals = visuals();
        style.text_styles = [
            (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
            (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Heading, FontId::new(15.0, FontFamily::Proportional)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
        let spacing = &mut style.spacing;
        spacing.item_spacing = vec2(GAP, HALF);
        spacing.button_padding = vec2(GAP, 3.0);
        spacing.interact_size = vec2(28.0, 22.0);
        spacing.window_margin = Margin::same(12);
        spacing.menu_margin = Margin::same(6);
        spacing.slider_rail_height = 4.0;
        spacing.icon_width = 15.0;
        spacing.icon_width_inner = 9.0;
        spacing.icon_spacing = 6.0;
        spacing.indent = 12.0;
        spacing.tooltip_width = 360.0;
        spacing.scroll = egui::style::ScrollStyle::thin();
        style.interaction.selectable_labels = false;
        style.interaction.tooltip_delay = 0.4;
        style.explanation_tooltips = false;
    });
}

fn visuals() -> egui::Visuals {
    let mut v = egui::Visuals::dark();
    v.panel_fill = PANEL;
    v.window_fill = BAR;
    v.window_stroke = Stroke::new(1.0, LINE);
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = CornerRadius::same(6);
    v.extreme_bg_color = WELL;
    v.faint_bg_color = Color32::from_white_alpha(4);
    v.code_bg_color = WELL;
    v.hyperlink_color = ACCENT;
    v.warn_fg_color = AMBER;
    v.error_fg_color = RED;
    v.weak_text_color = Some(TEXT_WEAK);
    v.selection.bg_fill = ACCENT_GROUND;
    v.selection.stroke = Stroke::new(1.0, TEXT_STRONG);
    v.slider_trailing_fill = true;
    v.handle_shape = egui::style::HandleShape::Circle;
    v.indent_has_left_vline = false;
    v.striped = false;
    let ground = |widget: &mut egui::style::WidgetVisuals, fill: Color32, line: Color32, text: Color32| {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::new(1.0, line);
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    };
    ground(&mut v.widgets.noninteractive, PANEL, LINE, TEXT);
    ground(&mut v.widgets.inactive, RAISED, Color32::TRANSPARENT, TEXT);
    ground(&mut v.widgets.hovered, RAISED_HOVER, Color32::TRANSPARENT, TEXT_STRONG);
    ground(&mut v.widgets.active, RAISED_HOVER, ACCENT, TEXT_STRONG);
    ground(&mut v.widgets.open, RAISED, LINE, TEXT_STRONG);
    v
}

/// Title of a panel or of a group.
pub fn heading(text: &str) -> RichText {
    RichText::new(text).strong().size(13.0).color(TEXT_STRONG)
}

/// Secondary text.
pub fn weak(text: impl Into<String>) -> RichText {
    RichText::new(text).color(TEXT_WEAK)
}

/// Frame of a side panel. It has no background: the window is cleared to [`PANEL`], and painting pixels twice is slow on a
/// software adapter.
pub fn panel_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin::symmetric(12, 10))
}

/// Frame of the bars at the top and bottom.
pub fn bar_frame() -> egui::Frame {
    egui::Frame::new().fill(BAR).inner_margin(Margin::symmetric(12, 6))
}

/// Frame of a message over the picture.
pub fn toast_frame(edge: Color32) -> egui::Frame {
    egui::Frame::new()
        .fill(Color32::from_rgba_unmultiplied(33, 34, 39, 240))
        .stroke(Stroke::new(1.0, edge.gamma_multiply(0.6)))
        .corner_radius(6.0)
        .inner_margin(Margin::symmetric(12, 8))
}

/// A warning or an error in a panel.
pub fn notice(ui: &mut egui::Ui, color: Color32, text: &str) {
    egui::Frame::new().fill(color.gamma_multiply(0.12)).corner_radius(4.0).inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        ui.label(RichText::new(text).color(color));
    });
}
