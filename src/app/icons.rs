//! The few icons the lab needs, drawn with lines, so that no font decides how they look.

use eframe::egui::{self, Color32, Pos2, Rect, Response, Sense, Stroke, Ui, pos2, vec2};

/// What an icon shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    Eye,
    EyeShut,
    Up,
    Down,
    Left,
    Right,
    /// An arrow that turns back.
    Reset,
    Cross,
    /// Four corners of a frame.
    Frame,
    Dice,
}

/// A square button without a frame; `name` is its tooltip and its accessible name.
pub fn icon_button(ui: &mut Ui, icon: Icon, name: &str) -> Response {
    let side = ui.spacing().interact_size.y;
    let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::click());
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact(&response);
        if response.hovered() || response.has_focus() {
            ui.painter().rect(rect.shrink(1.0), 4.0, visuals.weak_bg_fill, visuals.bg_stroke, egui::StrokeKind::Inside);
        }
        let color = if ui.is_enabled() { visuals.fg_stroke.color } else { ui.visuals().weak_text_color() };
        paint(ui.painter(), icon, rect.shrink(side * 0.27), color);
    }
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), name));
    response.on_hover_text(name).on_disabled_hover_text(name)
}

/// Draws `icon` into `rect`.
pub fn paint(painter: &egui::Painter, icon: Icon, rect: Rect, color: Color32) {
    let stroke = Stroke::new(1.5, color);
    let at = |x: f32, y: f32| pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height());
    let line = |points: &[Pos2]| {
        painter.line(points.to_vec(), stroke);
    };
    match icon {
        Icon::Eye | Icon::EyeShut => {
            let lid = |up: f32| {
                (0..=10)
                    .map(|i| i as f32 / 10.0)
                    .map(|x| at(x * 1.2 - 0.1, 0.5 - up * (x * std::f32::consts::PI).sin()))
                    .collect::<Vec<_>>()
            };
            line(&lid(0.4));
            line(&lid(-0.4));
            if icon == Icon::Eye {
                painter.circle_filled(rect.center(), rect.width() * 0.17, color);
            } else {
                line(&[at(0.0, 1.0), at(1.0, 0.0)]);
            }
        }
        Icon::Up => line(&[at(0.0, 0.7), at(0.5, 0.25), at(1.0, 0.7)]),
        Icon::Down => line(&[at(0.0, 0.3), at(0.5, 0.75), at(1.0, 0.3)]),
        Icon::Left => line(&[at(0.7, 0.0), at(0.25, 0.5), at(0.7, 1.0)]),
        Icon::Right => line(&[at(0.3, 0.0), at(0.75, 0.5), at(0.3, 1.0)]),
        Icon::Reset => {
            let arc = |i: i32| {
                let angle = (-100.0 + 25.0 * i as f32).to_radians();
                rect.center() + vec2(angle.cos(), angle.sin()) * rect.width() * 0.48
            };
            let points: Vec<_> = (0..=11).map(arc).collect();
            line(&points);
            line(&[points[0] + vec2(2.5, -3.5), points[0], points[0] + vec2(3.5, 2.5)]);
        }
        Icon::Cross => {
            line(&[at(0.1, 0.1), at(0.9, 0.9)]);
            line(&[at(0.9, 0.1), at(0.1, 0.9)]);
        }
        Icon::Frame => {
            for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                let inward = |v: f32| if v == 0.0 { 0.3 } else { 0.7 };
                line(&[at(inward(x), y), at(x, y), at(x, inward(y))]);
            }
        }
        Icon::Dice => {
            painter.rect_stroke(rect, 2.0, stroke, egui::StrokeKind::Middle);
            for (x, y) in [(0.27, 0.27), (0.5, 0.5), (0.73, 0.73)] {
                painter.circle_filled(at(x, y), rect.width() * 0.1, color);
            }
        }
    }
}
