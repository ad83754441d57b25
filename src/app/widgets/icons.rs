//! The icons of the lab, drawn with lines, so that they look the same with every font.

use eframe::egui::{self, Color32, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, pos2, vec2};

use super::theme;
use crate::app::editing::key_id::Keying;

/// What an icon shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    Eye,
    EyeShut,
    Up,
    Down,
    Left,
    Right,
    /// A circular arrow.
    Reset,
    Cross,
    /// Four corners of a frame.
    Frame,
    Dice,
    Play,
    Pause,
    /// A triangle that points left, to a bar.
    ToStart,
    StepBack,
    StepForward,
    /// Two arrows round a track.
    Loop,
    /// Three dots: a menu.
    More,
    /// A star's outline, and a filled one.
    Star,
    StarFull,
    /// Four squares.
    Grid,
    /// Lines of text beside squares.
    List,
    /// Six dots: something that can be dragged.
    Grip,
}

/// A square button without a frame; `name` is its tooltip and its accessible name.
pub fn icon_button(ui: &mut Ui, icon: Icon, name: &str) -> Response {
    let response = bare_button(ui, icon, |ui, response| {
        if ui.is_enabled() {
            ui.style().interact(response).fg_stroke.color
        } else {
            ui.visuals().weak_text_color()
        }
    });
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), name));
    response.on_hover_text(name).on_disabled_hover_text(name)
}

/// A button that is on or off.
pub fn toggle_button(ui: &mut Ui, icon: Icon, on: bool, name: &str) -> Response {
    let response = bare_button(ui, icon, |_, _| {
        if on {
            theme::accent()
        } else {
            theme::text_weak()
        }
    });
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, name));
    response
}

fn bare_button(ui: &mut Ui, icon: Icon, color: impl FnOnce(&Ui, &Response) -> Color32) -> Response {
    let side = ui.spacing().interact_size.y;
    let (rect, response) = ui.allocate_exact_size(vec2(side, side), Sense::click());
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact(&response);
        if response.hovered() || response.has_focus() {
            ui.painter().rect(
                rect.shrink(1.0),
                4.0,
                visuals.weak_bg_fill,
                visuals.bg_stroke,
                egui::StrokeKind::Inside,
            );
        }
        paint(
            ui.painter(),
            icon,
            rect.shrink(side * 0.27),
            color(ui, &response),
        );
    }
    response
}

/// The diamond beside a value: a gray outline if it is not animated, an outline in the accent color
/// if it is, filled at a keyframe.
pub fn key_button(ui: &mut Ui, rect: Rect, keying: Keying, path: &str) -> Response {
    let response = ui.interact(rect, egui::Id::unique((path, "key")), Sense::click());
    let (name, hint) = match keying {
        Keying::Still => (
            format!("Animate {path}"),
            "Animate this value: set its first key at the time shown",
        ),
        Keying::Between => (
            format!("Key {path}"),
            "Set a key at the time shown. Changing the value does the same.",
        ),
        Keying::OnKey => (
            format!("Remove key of {path}"),
            "Remove the key at this time",
        ),
    };
    let near = response.hovered() || response.has_focus();
    let color = match (keying, near && ui.is_enabled()) {
        (Keying::Still, false) => theme::text_weak().gamma_multiply(0.7),
        (Keying::Still, true) => theme::text_strong(),
        (_, false) => theme::accent(),
        (_, true) => theme::text_strong(),
    };
    let fill = if keying == Keying::OnKey {
        color
    } else {
        Color32::TRANSPARENT
    };
    paint_diamond(
        ui.painter(),
        rect.center(),
        if near { 5.5 } else { 4.5 },
        fill,
        color,
    );
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), &name));
    response.on_hover_text(hint)
}

/// The mark of a keyframe: a diamond with corners `r` points from its center.
pub fn paint_diamond(painter: &egui::Painter, at: Pos2, r: f32, fill: Color32, edge: Color32) {
    let points = [(0.0, -r), (r, 0.0), (0.0, r), (-r, 0.0)]
        .map(|(x, y)| at + vec2(x, y))
        .to_vec();
    painter.add(Shape::convex_polygon(points, fill, Stroke::new(1.3, edge)));
}

/// Draws `icon` into `rect`.
pub fn paint(painter: &egui::Painter, icon: Icon, rect: Rect, color: Color32) {
    let stroke = Stroke::new(1.5, color);
    let at = |x: f32, y: f32| {
        pos2(
            rect.left() + x * rect.width(),
            rect.top() + y * rect.height(),
        )
    };
    let line = |points: &[Pos2]| {
        painter.line(points.to_vec(), stroke);
    };
    let fill = |points: &[Pos2]| {
        painter.add(Shape::convex_polygon(points.to_vec(), color, Stroke::NONE));
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
            line(&[
                points[0] + vec2(2.5, -3.5),
                points[0],
                points[0] + vec2(3.5, 2.5),
            ]);
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
        Icon::Play => fill(&[at(0.12, -0.05), at(1.05, 0.5), at(0.12, 1.05)]),
        Icon::Pause => {
            fill(&[at(0.08, 0.0), at(0.38, 0.0), at(0.38, 1.0), at(0.08, 1.0)]);
            fill(&[at(0.62, 0.0), at(0.92, 0.0), at(0.92, 1.0), at(0.62, 1.0)]);
        }
        Icon::ToStart => {
            line(&[at(0.05, 0.0), at(0.05, 1.0)]);
            fill(&[at(1.0, 0.0), at(0.25, 0.5), at(1.0, 1.0)]);
        }
        Icon::StepBack => {
            line(&[at(0.95, 0.05), at(0.95, 0.95)]);
            line(&[at(0.65, 0.05), at(0.1, 0.5), at(0.65, 0.95)]);
        }
        Icon::StepForward => {
            line(&[at(0.05, 0.05), at(0.05, 0.95)]);
            line(&[at(0.35, 0.05), at(0.9, 0.5), at(0.35, 0.95)]);
        }
        Icon::Loop => {
            line(&[at(-0.1, 0.55), at(-0.1, 0.2), at(1.0, 0.2)]);
            line(&[at(0.75, -0.05), at(1.02, 0.2), at(0.75, 0.45)]);
            line(&[at(1.1, 0.45), at(1.1, 0.8), at(0.0, 0.8)]);
            line(&[at(0.25, 0.55), at(-0.02, 0.8), at(0.25, 1.05)]);
        }
        Icon::More => {
            for y in [0.05, 0.5, 0.95] {
                painter.circle_filled(at(0.5, y), rect.width() * 0.13, color);
            }
        }
        Icon::Star | Icon::StarFull => {
            let corner = |i: i32| {
                let (angle, radius) = (
                    (36.0 * i as f32 - 90.0).to_radians(),
                    if i % 2 == 0 { 0.6 } else { 0.26 },
                );
                rect.center() + vec2(angle.cos(), angle.sin()) * rect.width() * radius
            };
            let corners: Vec<Pos2> = (0..10).map(corner).collect();
            if icon == Icon::StarFull {
                // A star is not convex: a pentagon and five triangles are.
                fill(
                    &corners
                        .iter()
                        .skip(1)
                        .step_by(2)
                        .copied()
                        .collect::<Vec<_>>(),
                );
                (0..5).for_each(|i| {
                    fill(&[
                        corners[(2 * i + 9) % 10],
                        corners[2 * i],
                        corners[2 * i + 1],
                    ])
                });
            }
            painter.add(Shape::closed_line(corners, Stroke::new(1.2, color)));
        }
        Icon::Grid => {
            for (x, y) in [(0.0, 0.0), (0.58, 0.0), (0.0, 0.58), (0.58, 0.58)] {
                painter.rect_filled(
                    Rect::from_two_pos(at(x, y), at(x + 0.42, y + 0.42)),
                    1.0,
                    color,
                );
            }
        }
        Icon::List => {
            for y in [0.0, 0.4, 0.8] {
                painter.rect_filled(Rect::from_two_pos(at(0.0, y), at(0.2, y + 0.2)), 0.5, color);
                painter.rect_filled(
                    Rect::from_two_pos(at(0.34, y), at(1.0, y + 0.2)),
                    0.5,
                    color,
                );
            }
        }
        Icon::Grip => {
            for (x, y) in [
                (0.3, 0.05),
                (0.3, 0.5),
                (0.3, 0.95),
                (0.7, 0.05),
                (0.7, 0.5),
                (0.7, 0.95),
            ] {
                painter.circle_filled(at(x, y), rect.width() * 0.1, color);
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

/// A square of `color`, as in a legend.
pub fn swatch(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().rect_filled(rect, 2.0, color);
}
