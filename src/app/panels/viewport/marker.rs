//! The marker: a place in the picture that another panel points at.

use eframe::egui::{self, Align2, FontId, Rect, Sense, Ui, pos2, vec2};

use crate::app::{
    shell::state::State,
    widgets::{panel::describe, theme},
};

/// Radius of the ring, and lengths of its four strokes, points.
const RADIUS: f32 = 9.0;
const STROKE: f32 = 7.0;

/// Draws the marker over the picture at `at`, as long as that picture is shown.
pub fn marker_ui(ui: &Ui, state: &State, at: Rect) {
    let Some(marker) = state
        .picture
        .marker
        .as_ref()
        .filter(|marker| state.picture.screen.requested() == Some(&marker.of))
    else {
        return;
    };
    let center = at.min + vec2(marker.uv[0], marker.uv[1]) * at.size();
    let painter = ui.painter_at(at);
    for (width, color) in [(3.5, theme::view()), (1.5, theme::accent())] {
        painter.circle_stroke(center, RADIUS, (width, color));
        for direction in [
            vec2(1.0, 0.0),
            vec2(-1.0, 0.0),
            vec2(0.0, 1.0),
            vec2(0.0, -1.0),
        ] {
            painter.line_segment(
                [
                    center + direction * RADIUS,
                    center + direction * (RADIUS + STROKE),
                ],
                (width, color),
            );
        }
    }
    let galley = painter.layout_no_wrap(
        marker.text.clone(),
        FontId::proportional(12.0),
        theme::text_strong(),
    );
    // The text stays inside the picture.
    let plate_size = galley.size() + vec2(16.0, 8.0);
    let right = center.x + RADIUS + STROKE + 4.0;
    let left = if right + plate_size.x <= at.right() {
        right
    } else {
        center.x - RADIUS - STROKE - 4.0 - plate_size.x
    };
    let top =
        (center.y - plate_size.y * 0.5).clamp(at.top(), (at.bottom() - plate_size.y).max(at.top()));
    let plate = Rect::from_min_size(pos2(left.max(at.left()), top), plate_size);
    painter.rect_filled(plate, 4.0, theme::bar());
    painter.text(
        plate.center(),
        Align2::CENTER_CENTER,
        &marker.text,
        FontId::proportional(12.0),
        theme::text_strong(),
    );
    let response = ui.interact(plate, egui::Id::unique("marker"), Sense::hover());
    describe(&response, egui::Role::Label, &marker.text);
}
