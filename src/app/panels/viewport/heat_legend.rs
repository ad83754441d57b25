//! The legend of the overdraw heat map, over the lower left of the picture.

use egui::{Align2, Color32, FontId, Mesh, Rect, Ui, pos2, vec2};

use crate::{app::widgets::theme, effects::overdraw::Overdraw};

/// Size of the bar, points.
const BAR: [f32; 2] = [168.0, 8.0];

/// Space round the bar and its text, points.
const MARGIN: f32 = 10.0;

/// Segments of the bar; colors are interpolated between their ends.
const SEGMENTS: usize = 8;

/// A bar from one layer to the hottest color, with numbers at its ends and middle; `free` is what
/// it may cover.
pub fn heat_ui(ui: &Ui, free: Rect, params: &Overdraw) {
    let size = vec2(BAR[0] + 2.0 * MARGIN, BAR[1] + 2.0 * MARGIN + 24.0);
    if free.width() < size.x + 40.0 || free.height() < size.y + 80.0 {
        return;
    }
    let painter = ui.painter_at(free);
    let plate = Rect::from_min_size(
        pos2(free.left() + 12.0, free.bottom() - 12.0 - size.y),
        size,
    );
    painter.rect_filled(plate, 6.0, theme::bar().gamma_multiply(0.88));
    let bar = Rect::from_min_size(
        plate.min + vec2(MARGIN, MARGIN + 14.0),
        vec2(BAR[0], BAR[1]),
    );
    let color = |heat: f64| {
        let [r, g, b] = params
            .color(heat)
            .to_array()
            .map(|v| (v * 255.0 + 0.5) as u8);
        Color32::from_rgb(r, g, b)
    };
    let mut mesh = Mesh::default();
    for i in 0..=SEGMENTS {
        let heat = i as f64 / SEGMENTS as f64;
        let x = bar.left() + bar.width() * heat as f32;
        mesh.colored_vertex(pos2(x, bar.top()), color(heat));
        mesh.colored_vertex(pos2(x, bar.bottom()), color(heat));
    }
    for i in 0..SEGMENTS as u32 {
        mesh.add_triangle(2 * i, 2 * i + 1, 2 * i + 2);
        mesh.add_triangle(2 * i + 1, 2 * i + 2, 2 * i + 3);
    }
    painter.add(mesh);
    painter.text(
        plate.min + vec2(MARGIN, MARGIN - 3.0),
        Align2::LEFT_TOP,
        "layers per pixel",
        FontId::proportional(11.5),
        theme::text(),
    );
    for (heat, align) in [
        (0.0, Align2::LEFT_TOP),
        (0.5, Align2::CENTER_TOP),
        (1.0, Align2::RIGHT_TOP),
    ] {
        let at = pos2(bar.left() + bar.width() * heat as f32, bar.bottom() + 2.0);
        painter.text(
            at,
            align,
            number(params.layers_at(heat), heat == 1.0),
            FontId::monospace(10.5),
            theme::text_weak(),
        );
    }
}

/// `12`, `6.5`, `12+`: the hottest color means that many or more.
fn number(layers: f64, is_last: bool) -> String {
    let digits = usize::from(layers < 100.0 && (layers - layers.round()).abs() > 0.05);
    format!("{layers:.digits$}{}", if is_last { "+" } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [
                number(1.0, false),
                number(6.5, false),
                number(12.0, true),
                number(316.2, false)
            ],
            ["1", "6.5", "12+", "316"]
        );
    }
}
