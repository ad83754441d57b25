//! The loupe: the pixels round the one that the probe tells of, enlarged, with their values written
//! in them where there is room.

use egui::{self, Align2, Color32, FontId, Rect, Sense, Ui, pos2, vec2};

use crate::{
    app::{
        picture::apply::look_into,
        picture::{findings::Findings, overlay::OverlaySelection},
        shell::command::Commands,
        widgets::theme,
    },
    frame::NO_TRIANGLE,
};

/// Sides of an enlarged pixel, points.
const ZOOMS: [f32; 4] = [8.0, 16.0, 32.0, 64.0];

/// From this side on values are written in the pixels, and from this one ids of triangles, too.
const VALUES: f32 = 32.0;
const IDS: f32 = 64.0;

/// Most of the loupe's width, and its height, points.
const WIDTH: f32 = 480.0;
const HEIGHT: f32 = 224.0;

/// How much it enlarges.
pub struct Loupe {
    /// Index in [`ZOOMS`].
    zoom: usize,
}

impl Default for Loupe {
    fn default() -> Self {
        Self { zoom: 2 }
    }
}

impl Loupe {
    /// Shows the pixels of `found` round `pixel` (column, row). A click asks about another one.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        found: &Findings,
        overlays: &OverlaySelection,
        pixel: [u32; 2],
        commands: &Commands,
    ) {
        ui.horizontal(|ui| {
            for (text, name, step) in [
                ("\u{2212}", "Smaller pixels", -1),
                ("+", "Larger pixels", 1),
            ] {
                let next = self.zoom.checked_add_signed(step);
                let next = next.filter(|zoom| *zoom < ZOOMS.len());
                let button = ui.add_enabled(next.is_some(), egui::Button::new(text).small());
                if button.accessible_name(name).clicked() {
                    self.zoom = next.unwrap_or(self.zoom);
                }
            }
            ui.label(theme::weak(format!("{} \u{d7}", ZOOMS[self.zoom])));
        });
        let side = ZOOMS[self.zoom];
        let size = vec2(ui.available_width().min(WIDTH), HEIGHT);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, theme::well());
        // The upper left corner of the picture, so that the pixel lies in the middle.
        let middle = vec2(pixel[0] as f32 + 0.5, pixel[1] as f32 + 0.5);
        let corner = rect.center() - middle * side;
        let seen = |low: f32, high: f32, end: u32| {
            let low = (low / side).floor().max(0.0) as u32;
            low..((high / side).ceil().max(0.0) as u32).min(end)
        };
        let columns = seen(
            rect.left() - corner.x,
            rect.right() - corner.x,
            found.size[0],
        );
        let rows = seen(
            rect.top() - corner.y,
            rect.bottom() - corner.y,
            found.size[1],
        );
        for y in rows {
            for x in columns.clone() {
                let i = (y * found.size[0] + x) as usize;
                let min = corner + vec2(x as f32, y as f32) * side;
                let cell = Rect::from_min_size(min, vec2(side, side));
                pixel_ui(&painter, found, overlays, i, cell);
            }
        }
        let ring = Rect::from_min_size(corner + (middle - vec2(0.5, 0.5)) * side, vec2(side, side));
        for (width, color) in [(4.0, theme::view()), (2.0, theme::accent())] {
            painter.rect_stroke(ring, 0.0, (width, color), egui::StrokeKind::Outside);
        }
        let [r, g, b, a] = found.color[(pixel[1] * found.size[0] + pixel[0]) as usize];
        response.widget_info(|| {
            let text = format!("Pixels round {}, {}: {r} {g} {b} {a}", pixel[0], pixel[1]);
            egui::WidgetInfo::labeled(egui::Role::Image, true, text)
        });
        if let Some(pointer) = response
            .interact_pointer_pos()
            .filter(|_| response.clicked())
        {
            let at = (pointer - corner) / side;
            let inside = |t: f32, end: u32| (0.0..end as f32).contains(&t).then_some(t as u32);
            if let Some((x, y)) = inside(at.x, found.size[0]).zip(inside(at.y, found.size[1])) {
                let pixel = [x, y];
                commands.run(move |app| look_into(&mut app.state, pixel, ""));
            }
        }
    }
}

/// Pixel `i` with its values, framed in the colors of the overlays that paint it.
fn pixel_ui(
    painter: &egui::Painter,
    found: &Findings,
    overlays: &OverlaySelection,
    i: usize,
    cell: Rect,
) {
    let [r, g, b, a] = found.color[i];
    let color = Color32::from_rgba_unmultiplied(r, g, b, a);
    painter.rect_filled(cell, 0.0, color);
    let mut shown = overlays.shown().iter().rev();
    if let Some(overlay) = shown.find(|overlay| found.is_painted(**overlay, i)) {
        let frame = cell.shrink(1.0);
        painter.rect_stroke(frame, 0.0, (1.5, overlay.color()), egui::StrokeKind::Inside);
    }
    let side = cell.width();
    if side < VALUES {
        return;
    }
    let mut lines = [r, g, b].map(|value| value.to_string()).to_vec();
    if side >= IDS {
        lines.push(match found.triangle_ids[i] {
            NO_TRIANGLE => "empty".into(),
            id => format!("t {id}"),
        });
    }
    // Readable on what lies behind: the picture on the dark ground of the loupe.
    let light = |v: u8| f32::from(v) * f32::from(a) / 255.0;
    let is_bright = 0.3 * light(r) + 0.6 * light(g) + 0.1 * light(b) > 128.0;
    let ink = match is_bright {
        true => Color32::BLACK,
        false => Color32::WHITE,
    };
    let line = side / (lines.len() as f32 + 0.6);
    for (k, text) in lines.iter().enumerate() {
        let at = pos2(cell.center().x, cell.top() + line * (k as f32 + 0.3));
        let font = FontId::monospace((0.9 * line).min(11.0));
        painter.text(at, Align2::CENTER_TOP, text, font, ink);
    }
}
