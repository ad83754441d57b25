//! The marker: a place in the picture that another panel points at.

use egui::{self, Align2, FontId, Rect, Sense, Ui, pos2, vec2};

use crate::app::{
    shell::state::State,
    widgets::{
        panel::{describe, plate},
        theme,
    },
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
    let right = center.x + RADIUS + STROKE + 4.0;
    let width = painter.layout_no_wrap(
        marker.text.clone(),
        FontId::proportional(12.0),
        theme::text_strong(),
    );
    // The text stays inside the picture, beside the ring.
    let (x, align) = match right + width.size().x + 12.0 <= at.right() {
        true => (right, Align2::LEFT_CENTER),
        false => (center.x - RADIUS - STROKE - 4.0, Align2::RIGHT_CENTER),
    };
    let plate = plate(&painter, pos2(x, center.y), align, at, &marker.text);
    let response = ui.interact(plate, egui::Id::unique("marker"), Sense::hover());
    describe(&response, egui::Role::Label, &marker.text);
}
