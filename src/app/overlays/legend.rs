//! The legend of the overlays: what was found, in numbers from the data; what has none is left out.

use eframe::egui::{self, Color32, Rect, RichText, Ui, pos2, vec2};

use super::{App, Findings, Overlay, Overlays, grouped, swatch, theme};

/// Height of a line, and the air round all of them, points.
const LINE: f32 = 18.0;
const AIR: f32 = 8.0;

/// A line of the legend; without a colour it is a sentence.
#[derive(Clone, Debug, PartialEq)]
struct Line {
    swatch: Option<Color32>,
    text: String,
    color: Color32,
}

impl Line {
    fn sentence(color: Color32, text: impl Into<String>) -> Self {
        Self { swatch: None, text: text.into(), color }
    }
}

/// What the legend says of `found`.
fn lines(overlays: &Overlays, found: &Findings) -> Vec<Line> {
    let shown = Overlay::listed().filter(|overlay| overlays.shown.contains(overlay));
    let mut lines: Vec<Line> = shown
        .filter(|overlay| found.count(*overlay) > 0)
        .map(|overlay| {
            let (name, count) = (overlay.name().to_lowercase(), grouped(found.count(overlay)));
            let text = match overlay {
                Overlay::Colour => {
                    let most = found.faults.colour.iter().max().copied().unwrap_or(0);
                    format!("{name} × {}: {count} px, at most {most} of 255", overlays.gain)
                }
                Overlay::Layers => format!("{name}: up to {}", found.layers.iter().max().copied().unwrap_or(0)),
                Overlay::TriangleIds => format!("{}: {count} px are covered", overlay.name().to_lowercase()),
                _ => format!("{}: {count} px", if overlay == Overlay::Unsound { overlay.name().to_owned() } else { name }),
            };
            Line { swatch: Some(overlay.color()), text, color: theme::TEXT_STRONG }
        })
        .collect();
    let asks_for_faults = overlays.shown.iter().any(|overlay| overlay.is_fault());
    let is_faultless = Overlay::ALL.iter().all(|o| !(o.is_fault() && overlays.shown.contains(o)) || found.count(*o) == 0);
    let pixels = grouped(found.faults.pixels() as u64);
    if asks_for_faults && is_faultless {
        let asked: Vec<_> = Overlay::ALL.into_iter().filter(|o| o.is_fault() && overlays.shown.contains(o)).collect();
        let what = if let [one] = asked[..] { format!("no {}", one.name().to_lowercase()) } else { "nothing is wrong".into() };
        lines.push(Line::sentence(theme::GREEN, format!("{what}: 0 of {pixels} pixels")));
    } else if lines.is_empty() {
        lines.push(Line::sentence(theme::TEXT, format!("nothing to show in {pixels} pixels")));
    }
    lines
}

impl App {
    /// What is known of the pixel under the pointer.
    fn hovered_line(&self, ui: &Ui, at: Rect) -> Option<Line> {
        let found = self.findings().filter(|_| self.motion.divisor == 1)?;
        let pointer = ui.input(|i| i.pointer.hover_pos()).filter(|pointer| at.contains(*pointer) && ui.rect_contains_pointer(at))?;
        let share = (pointer - at.min) / at.size();
        let [x, y] = [(share.x, found.size[0]), (share.y, found.size[1])].map(|(share, side)| ((share * side as f32) as u32).min(side - 1));
        Some(Line::sentence(theme::TEXT_WEAK, format!("{x}, {y}: {}", found.pixel_text((y * found.size[0] + x) as usize))))
    }

    /// The legend over the lower left of `picture`; returns what it leaves free.
    pub(in crate::app) fn overlay_legend_ui(&self, ui: &mut Ui, picture: Rect, at: Rect) -> Rect {
        if !self.overlays.is_any() || self.screen.picture().is_none() || self.compare.hides_b() {
            return picture;
        }
        let mut lines = match self.findings() {
            Some(found) if self.motion.divisor == 1 => lines(&self.overlays, found),
            _ if self.verifying > 0 => vec![Line::sentence(theme::TEXT, "The oracle judges this picture")],
            _ if self.overlays_are_settled() => vec![Line::sentence(theme::RED, "This picture could not be judged; the log says why")],
            _ => vec![Line::sentence(theme::TEXT_WEAK, "Overlays appear when the picture rests")],
        };
        lines.extend(self.hovered_line(ui, at));
        let height = lines.len() as f32 * LINE + 2.0 * AIR;
        let plate = Rect::from_min_size(pos2(picture.left() + 12.0, picture.bottom() - 12.0 - height), vec2(400.0, height));
        if plate.top() < picture.top() + 44.0 || picture.width() < 240.0 {
            return picture;
        }
        let mut child = ui.new_child(egui::UiBuilder::new().id_salt("overlay legend").max_rect(plate));
        let frame = theme::toast_frame(theme::LINE).inner_margin(egui::Margin::symmetric(10, AIR as i8));
        frame.show(&mut child, |ui| {
            ui.spacing_mut().item_spacing = vec2(theme::GAP, 0.0);
            ui.spacing_mut().interact_size.y = LINE;
            for Line { swatch: color, text, color: ink } in &lines {
                ui.horizontal(|ui| {
                    ui.set_height(LINE);
                    if let Some(color) = color {
                        swatch(ui, *color);
                    }
                    ui.label(RichText::new(text).size(12.0).color(*ink));
                });
            }
        });
        Rect::from_min_max(picture.min, pos2(picture.right(), plate.top() + 4.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        frame::Frame,
        gpu::Capture,
        measure::{
            Verdict,
            faults::{ErrorMap, PixelError},
        },
    };

    fn found(marked: &[usize]) -> Findings {
        let picture = [[9; 4]; 6];
        let faults = ErrorMap::new(&picture, &picture, |i| {
            if marked.contains(&i) { vec![PixelError::TriangleId, PixelError::Hole] } else { Vec::new() }
        });
        let frame = Frame { width: 3, height: 2, triangle_id: vec![0; 6], color: picture.to_vec(), ..Default::default() };
        let capture = Capture { frame, geometry: Default::default(), layers: None, previous: None, shown: None };
        Findings::new(capture, Verdict { faults, ..Default::default() }, None)
    }

    #[test]
    fn the_legend_names_what_there_is_and_says_so_when_there_is_nothing() {
        let mut overlays = Overlays::default();
        overlays.toggle();
        let text = |overlays: &Overlays, found: &Findings| lines(overlays, found).into_iter().map(|line| line.text).collect::<Vec<_>>();
        assert_eq!(text(&overlays, &found(&[])), ["nothing is wrong: 0 of 6 pixels"]);
        assert_eq!(text(&overlays, &found(&[1, 4])), ["wrong triangle id: 2 px", "holes: 2 px"]);
        overlays.shown = vec![Overlay::Depth];
        assert_eq!(text(&overlays, &found(&[1])), ["no wrong depth winner: 0 of 6 pixels"]);
        overlays.shown = vec![Overlay::Edges];
        assert_eq!(text(&overlays, &found(&[1])), ["nothing to show in 6 pixels"]);
        overlays.shown = vec![Overlay::TriangleIds];
        assert_eq!(text(&overlays, &found(&[1])), ["triangle id ids: 6 px are covered"]);
    }
}
