//! The comparison over the picture: A, the divider, the bar and the plates.

use egui::{self, Color32, CursorIcon, Pos2, Rect, Sense, Ui, pos2, vec2};

use super::{
    compare::{Compare, Mode},
    compare_bar::{bar_ui, labels_ui},
    compare_plates::plates_ui,
    layout::fit_aspect,
    overlays::OverlayPainter,
};
use crate::app::{
    picture::screen::Screen,
    shell::{command::Commands, state::State},
    widgets::theme,
};

/// Shows A over B, the overlays of B, the divider, the bar and the plates. `rect` is the whole
/// viewport and `at` where B is. Returns what they do not cover.
pub fn compare_ui(
    ui: &mut Ui,
    compare: &mut Compare,
    (state, commands): (&State, &Commands),
    (rect, at): (Rect, Rect),
    overlays: &mut OverlayPainter,
) -> Rect {
    let Some(mode) = compare.mode else {
        overlays.paint(ui, state, at, rect);
        return rect;
    };
    let (half_a, half_b) = rect.split_left_right_at_fraction(0.5);
    let divider = at.left() + at.width() * compare.split;
    let [side_a, side_b] = match mode {
        Mode::Wipe => [rect.with_max_x(divider), rect.with_min_x(divider)],
        Mode::SideBySide => [half_a, half_b],
        Mode::A | Mode::Difference => [rect, Rect::NOTHING],
        Mode::B => [Rect::NOTHING, rect],
    };
    let picture = compare.screen.as_ref().and_then(Screen::picture);
    if let Some((blit, size)) = picture.filter(|_| side_a.width() >= 1.0) {
        let blit = match mode {
            Mode::Difference => compare
                .screen
                .as_ref()
                .and_then(|a| a.difference(&state.picture.screen, compare.gain)),
            _ => Some(blit.clone()),
        };
        let target = fit_aspect(
            if mode == Mode::SideBySide {
                half_a
            } else {
                rect
            },
            size,
        );
        if mode == Mode::SideBySide {
            ui.painter_at(half_a)
                .rect_filled(half_a, 0.0, theme::view());
        }
        ui.painter_at(side_a)
            .extend(blit.map(|blit| blit.shape(target)));
    }
    if side_b.is_positive() {
        overlays.paint(ui, state, at, side_b);
    }
    match mode {
        Mode::Wipe => divider_ui(ui, "wipe", &mut compare.split, at),
        Mode::SideBySide => drop(ui.painter().vline(
            half_a.right(),
            rect.y_range(),
            (1.5, theme::line()),
        )),
        Mode::Difference | Mode::A | Mode::B => {}
    }
    labels_ui(
        ui,
        rect,
        [&compare.name(), &Compare::name_b(state)],
        [side_a, side_b],
        mode == Mode::Difference,
    );
    bar_ui(ui, compare, state, rect);
    plates_ui(ui, compare, (state, commands), rect, mode)
}

/// The divider of a wipe. It can be dragged, or moved with the arrow keys while it has the focus.
pub fn divider_ui(ui: &Ui, id: &str, split: &mut f32, at: Rect) {
    let x = (at.left() + at.width() * *split).round();
    let grip = Rect::from_min_max(pos2(x - 7.0, at.top()), pos2(x + 7.0, at.bottom()));
    let response = ui
        .interact(grip, egui::Id::unique(id), Sense::click_and_drag())
        .on_hover_cursor(CursorIcon::ResizeHorizontal);
    response.widget_info(|| egui::WidgetInfo::slider(true, f64::from(*split), "Wipe divider"));
    if response.dragged()
        && let Some(pointer) = response.interact_pointer_pos()
    {
        *split = (pointer.x - at.left()) / at.width().max(1.0);
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if response.double_clicked() {
        *split = 0.5;
    }
    if response.has_focus() {
        let arrows = egui::EventFilter {
            horizontal_arrows: true,
            ..Default::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        let presses = |key| ui.input(|i| i.num_presses(key)) as f32;
        *split += 0.02 * (presses(egui::Key::ArrowRight) - presses(egui::Key::ArrowLeft));
    }
    *split = split.clamp(0.0, 1.0);
    let is_near = response.hovered() || response.dragged() || response.has_focus();
    paint_divider(
        ui,
        at,
        x,
        if is_near {
            theme::accent()
        } else {
            theme::text_strong()
        },
    );
}

/// A line with dark edges, visible on any picture, and a knob with two arrows.
fn paint_divider(ui: &Ui, at: Rect, x: f32, color: Color32) {
    let painter = ui.painter_at(at);
    painter.vline(x, at.y_range(), (4.0, Color32::from_black_alpha(140)));
    painter.vline(x, at.y_range(), (1.5, color));
    let knob = pos2(x, at.center().y);
    painter.circle(knob, 12.0, theme::bar(), (1.5, color));
    for side in [-1.0, 1.0] {
        let tip = knob + vec2(7.0 * side, 0.0);
        let points: [Pos2; 3] = [
            tip,
            tip + vec2(-4.0 * side, -4.0),
            tip + vec2(-4.0 * side, 4.0),
        ];
        painter.add(egui::Shape::convex_polygon(
            points.to_vec(),
            color,
            egui::Stroke::NONE,
        ));
    }
}
