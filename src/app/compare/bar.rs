//! The bar of a comparison: how A and B are shown, how they differ, and which side is which.

use eframe::egui::{self, Align2, FontId, Rect, RichText, Ui, pos2, vec2};

use super::{Show, Verdict};
use crate::{
    app::{App, presets::grouped, theme},
    measure::compare::{pictures, triangle_ids},
};

/// How A and B differ, as their verdicts tell.
pub struct Delta {
    of: [Verdict; 2],
    text: String,
}

/// The ways to show both at once.
const WAYS: [(Show, &str); 3] = [(Show::Wipe, "Wipe"), (Show::Beside, "Side by side"), (Show::Difference, "Difference")];

/// Height of the bar, points.
const BAR: f32 = 30.0;

/// From the lower edge of the picture up to the bar and to the labels, points: above the plates of both sides.
const UP_TO_BAR: f32 = 106.0;
const UP_TO_LABELS: f32 = 114.0;

impl App {
    /// A label in the picture on each side.
    pub(super) fn labels_ui(&self, ui: &Ui, sides: [Rect; 2], is_difference: bool) {
        let kept = self.compare.kept.as_ref().map(|kept| if kept.name.is_empty() { "kept look" } else { &kept.name });
        let first = if is_difference { "|A \u{2212} B|".to_owned() } else { format!("A \u{b7} {}", kept.unwrap_or("reference")) };
        for (side, text, align) in
            [(sides[0], first, Align2::LEFT_BOTTOM), (sides[1], "B \u{b7} this preset".to_owned(), Align2::RIGHT_BOTTOM)]
        {
            // A side too narrow for its name goes without.
            if side.width() < 140.0 || !side.is_positive() {
                continue;
            }
            let corner = align.pos_in_rect(&side.shrink2(vec2(19.0, UP_TO_LABELS)));
            let painter = ui.painter_at(side);
            let words = painter.layout_no_wrap(text, FontId::proportional(13.0), theme::TEXT_STRONG);
            let place = align.anchor_size(corner, words.size());
            painter.rect_filled(place.expand2(vec2(7.0, 4.0)), 5.0, theme::BAR.gamma_multiply(0.88));
            painter.galley(place.min, words, theme::TEXT_STRONG);
        }
    }

    /// How both are shown, and how far apart they are.
    pub(super) fn compare_bar_ui(&mut self, ui: &mut Ui, rect: Rect) {
        let text = self.delta_text();
        let width = 560.0f32.min(rect.width() - 24.0);
        let corner = pos2(rect.center().x - width / 2.0, rect.bottom() - UP_TO_BAR);
        let place = Rect::from_min_size(corner, vec2(width, BAR));
        let mut bar = ui.new_child(egui::UiBuilder::new().id_salt("compare bar").max_rect(place));
        theme::toast_frame(theme::LINE).inner_margin(egui::Margin::symmetric(8, 3)).show(&mut bar, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                for (way, name) in WAYS {
                    let button = egui::Button::new(name).small().selected(self.compare.show == Some(way));
                    if ui.add(button).accessible_name(format!("Compare: {}", name.to_lowercase())).clicked() {
                        self.compare.show = Some(way);
                    }
                }
                if self.compare.show == Some(Show::Difference) {
                    let gain = egui::DragValue::new(&mut self.compare.gain).range(1..=255).prefix("\u{d7} ").speed(0.3);
                    ui.add(gain).accessible_name("Difference gain").on_hover_text("How much a difference is amplified");
                }
                ui.separator();
                let label = egui::Label::new(RichText::new(&text).size(12.0).color(theme::TEXT)).truncate();
                ui.add(label).on_hover_text("A against B, pixel by pixel, once the oracle has judged both (V)");
            });
        });
    }

    /// `max \u{394} 12, RMS 0.31, 5 other triangle ids`, as far as both were judged as they stand.
    fn delta_text(&mut self) -> String {
        let side =
            |verdict: &Option<Verdict>, wanted: Option<&super::Inputs>| verdict.clone().filter(|verdict| wanted == Some(&verdict.of));
        let a = side(&self.compare.verdict, self.compare.wanted.as_ref());
        let b = side(&self.verdict, self.motion.wanted.as_ref());
        let Some((a, b)) = a.zip(b) else { return "A and B not compared yet".into() };
        let is_known = |delta: &&Delta| delta.of[0].of == a.of && delta.of[1].of == b.of;
        if let Some(delta) = self.compare.delta.as_ref().filter(is_known) {
            return delta.text.clone();
        }
        let (found_a, found_b) = (&a.findings, &b.findings);
        let text = if found_a.size == found_b.size {
            let colors = pictures(&found_a.color, &found_b.color, 0);
            let others = triangle_ids(&found_a.triangle_ids, &found_b.triangle_ids).different;
            let word = if others == 1 { "triangle id" } else { "triangle ids" };
            format!("max \u{394} {}, RMS {:.3}, {} other {word}", colors.max_delta, colors.rms, grouped(others))
        } else {
            let [w, h] = found_a.size;
            let [v, g] = found_b.size;
            format!("A draws {w} x {h} pixels, B {v} x {g}")
        };
        self.compare.delta = Some(Delta { of: [a, b], text: text.clone() });
        text
    }
}
