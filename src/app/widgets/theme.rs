//! The visual style of the lab: neutral grays that leave the colors to the picture, in a dark and a
//! light theme, one accent, an 8-point grid.

use std::cell::Cell;

use egui::{
    self, Color32, CornerRadius, FontFamily, FontId, Margin, RichText, Stroke, TextStyle, vec2,
};

/// The colors of the window in one theme.
struct Palette {
    /// Behind the picture.
    view: Color32,
    /// Panels.
    panel: Color32,
    /// Bars at the top and bottom, group headers.
    bar: Color32,
    /// Wells: rails, text fields.
    well: Color32,
    /// Buttons at rest and hovered.
    raised: Color32,
    raised_hover: Color32,
    /// Separators.
    line: Color32,
    text_strong: Color32,
    text: Color32,
    /// Secondary, and still readable.
    text_weak: Color32,
    /// The one accent: selection, changed values, focus.
    accent: Color32,
    /// The accent as a background of text.
    accent_ground: Color32,
    amber: Color32,
    red: Color32,
    green: Color32,
}

const DARK: Palette = Palette {
    view: Color32::from_rgb(16, 17, 20),
    panel: Color32::from_rgb(27, 28, 32),
    bar: Color32::from_rgb(33, 34, 39),
    well: Color32::from_rgb(17, 18, 21),
    raised: Color32::from_rgb(46, 48, 54),
    raised_hover: Color32::from_rgb(60, 63, 71),
    line: Color32::from_rgb(48, 50, 56),
    text_strong: Color32::from_rgb(244, 245, 247),
    text: Color32::from_rgb(206, 209, 215),
    text_weak: Color32::from_rgb(143, 148, 158),
    accent: Color32::from_rgb(94, 168, 255),
    accent_ground: Color32::from_rgb(33, 66, 112),
    amber: Color32::from_rgb(240, 178, 74),
    red: Color32::from_rgb(255, 115, 108),
    green: Color32::from_rgb(122, 201, 143),
};

const LIGHT: Palette = Palette {
    view: Color32::from_rgb(205, 208, 213),
    panel: Color32::from_rgb(246, 247, 249),
    bar: Color32::from_rgb(235, 237, 241),
    well: Color32::from_rgb(255, 255, 255),
    raised: Color32::from_rgb(220, 223, 229),
    raised_hover: Color32::from_rgb(205, 210, 218),
    line: Color32::from_rgb(201, 205, 212),
    text_strong: Color32::from_rgb(16, 18, 22),
    text: Color32::from_rgb(48, 52, 60),
    text_weak: Color32::from_rgb(92, 98, 108),
    accent: Color32::from_rgb(20, 96, 200),
    accent_ground: Color32::from_rgb(188, 214, 250),
    amber: Color32::from_rgb(138, 84, 0),
    red: Color32::from_rgb(184, 34, 28),
    green: Color32::from_rgb(18, 108, 52),
};

thread_local! {
    /// The palette of the window that this thread shows. Tests show several windows, each on a thread of its own.
    static SHOWN: Cell<&'static Palette> = const { Cell::new(&DARK) };
}

/// The colors of the theme that is shown.
macro_rules! colors {
    ($($name:ident),*) => {
        $(pub fn $name() -> Color32 {
            SHOWN.get().$name
        })*
    };
}

colors!(
    view,
    panel,
    bar,
    well,
    raised,
    raised_hover,
    line,
    text_strong,
    text,
    text_weak,
    accent,
    accent_ground,
    amber,
    red,
    green
);

/// Half a grid step: between parts of a group.
pub const HALF: f32 = 4.0;
/// The grid.
pub const GAP: f32 = 8.0;
/// Height of a row of controls.
pub const ROW: f32 = 24.0;

/// Which theme is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ThemeChoice {
    /// That of the desktop; dark where the desktop has none.
    #[default]
    System,
    Light,
    Dark,
}

impl ThemeChoice {
    pub const ALL: [Self; 3] = [Self::System, Self::Light, Self::Dark];

    pub const fn label(self) -> &'static str {
        match self {
            Self::System => "Like the system",
            Self::Light => "Light",
            Self::Dark => "Dark",
        }
    }

    /// Shows it from the next frame on.
    pub fn choose(self, ctx: &egui::Context) {
        ctx.set_theme(match self {
            Self::System => egui::ThemePreference::System,
            Self::Light => egui::ThemePreference::Light,
            Self::Dark => egui::ThemePreference::Dark,
        });
    }
}

/// Makes the functions of this module return the colors of the theme that `ctx` shows. Call it when
/// a frame begins.
pub fn follow(ctx: &egui::Context) {
    SHOWN.set(if ctx.theme() == egui::Theme::Light {
        &LIGHT
    } else {
        &DARK
    });
}

/// Sets up egui's dark and light styles.
pub fn apply(ctx: &egui::Context) {
    ctx.set_visuals_of(egui::Theme::Dark, visuals(egui::Visuals::dark(), &DARK));
    ctx.set_visuals_of(egui::Theme::Light, visuals(egui::Visuals::light(), &LIGHT));
    ctx.all_styles_mut(|style| {
        style.text_styles = [
            (
                TextStyle::Small,
                FontId::new(11.0, FontFamily::Proportional),
            ),
            (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
            (
                TextStyle::Button,
                FontId::new(13.0, FontFamily::Proportional),
            ),
            (
                TextStyle::Heading,
                FontId::new(15.0, FontFamily::Proportional),
            ),
            (
                TextStyle::Monospace,
                FontId::new(12.0, FontFamily::Monospace),
            ),
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

fn visuals(mut v: egui::Visuals, colors: &Palette) -> egui::Visuals {
    v.panel_fill = colors.panel;
    v.window_fill = colors.bar;
    v.window_stroke = Stroke::new(1.0, colors.line);
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = CornerRadius::same(6);
    v.extreme_bg_color = colors.well;
    v.faint_bg_color = colors.text_strong.gamma_multiply(0.02);
    v.code_bg_color = colors.well;
    v.hyperlink_color = colors.accent;
    v.warn_fg_color = colors.amber;
    v.error_fg_color = colors.red;
    v.weak_text_color = Some(colors.text_weak);
    v.selection.bg_fill = colors.accent_ground;
    v.selection.stroke = Stroke::new(1.0, colors.text_strong);
    v.slider_trailing_fill = true;
    v.handle_shape = egui::style::HandleShape::Circle;
    v.indent_has_left_vline = false;
    v.striped = false;
    let ground =
        |widget: &mut egui::style::WidgetVisuals, fill: Color32, line: Color32, text: Color32| {
            widget.bg_fill = fill;
            widget.weak_bg_fill = fill;
            widget.bg_stroke = Stroke::new(1.0, line);
            widget.fg_stroke = Stroke::new(1.0, text);
            widget.corner_radius = CornerRadius::same(4);
            widget.expansion = 0.0;
        };
    ground(
        &mut v.widgets.noninteractive,
        colors.panel,
        colors.line,
        colors.text,
    );
    ground(
        &mut v.widgets.inactive,
        colors.raised,
        Color32::TRANSPARENT,
        colors.text,
    );
    ground(
        &mut v.widgets.hovered,
        colors.raised_hover,
        Color32::TRANSPARENT,
        colors.text_strong,
    );
    ground(
        &mut v.widgets.active,
        colors.raised_hover,
        colors.accent,
        colors.text_strong,
    );
    ground(
        &mut v.widgets.open,
        colors.raised,
        colors.line,
        colors.text_strong,
    );
    v
}

/// Title of a panel or of a group.
pub fn heading(text: &str) -> RichText {
    RichText::new(text).strong().size(13.0).color(text_strong())
}

/// Title of a dialog.
pub fn title(text: impl Into<String>) -> RichText {
    strong(text).size(15.0).strong()
}

/// Text that stands out.
pub fn strong(text: impl Into<String>) -> RichText {
    RichText::new(text).color(text_strong())
}

/// Secondary text in small letters.
pub fn small(text: impl Into<String>) -> RichText {
    weak(text).size(11.0)
}

/// Secondary text.
pub fn weak(text: impl Into<String>) -> RichText {
    RichText::new(text).color(text_weak())
}

/// Frame of a side panel. It has no background: the window is cleared to the color of panels, and
/// painting pixels twice is slow on a software adapter.
pub fn panel_frame() -> egui::Frame {
    egui::Frame::new().inner_margin(Margin::symmetric(12, 10))
}

/// Frame of the bars at the top and bottom.
pub fn bar_frame() -> egui::Frame {
    egui::Frame::new()
        .fill(bar())
        .inner_margin(Margin::symmetric(12, 6))
}

/// Frame of a message over the picture.
pub fn toast_frame(edge: Color32) -> egui::Frame {
    egui::Frame::new()
        .fill(bar().gamma_multiply(0.95))
        .stroke(Stroke::new(1.0, edge.gamma_multiply(0.6)))
        .corner_radius(6.0)
        .inner_margin(Margin::symmetric(12, 8))
}

/// A warning or an error in a panel.
pub fn notice(ui: &mut egui::Ui, color: Color32, text: &str) {
    egui::Frame::new()
        .fill(color.gamma_multiply(0.12))
        .corner_radius(4.0)
        .inner_margin(Margin::symmetric(8, 6))
        .show(ui, |ui| {
            ui.set_min_width(ui.available_width());
            ui.label(RichText::new(text).color(color));
        });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast of two opaque colors, from 1 to 21, as the Web Content Accessibility Guidelines
    /// define it.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [r, g, b] =
                [color.r(), color.g(), color.b()].map(egui::ecolor::linear_f32_from_gamma_u8);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn every_text_can_be_read_on_every_ground_of_both_themes() {
        for (name, p) in [("dark", &DARK), ("light", &LIGHT)] {
            for (ground_name, ground) in [("panel", p.panel), ("bar", p.bar)] {
                for (text_name, text) in [
                    ("strong", p.text_strong),
                    ("text", p.text),
                    ("weak", p.text_weak),
                    ("accent", p.accent),
                    ("amber", p.amber),
                    ("red", p.red),
                    ("green", p.green),
                ] {
                    let contrast = contrast(text, ground);
                    assert!(
                        contrast >= 4.5,
                        "{name}: {text_name} on {ground_name} has a contrast of {contrast:.2}"
                    );
                }
            }
            for ground in [p.accent_ground, p.raised, p.raised_hover, p.well] {
                assert!(
                    contrast(p.text_strong, ground) >= 7.0,
                    "{name}: text on {ground:?}"
                );
            }
        }
    }
}
